// `springstab work-precision`: error against run time on the user's own scene.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/journal.h"
#include "experiments/studies/precision/contest.h"
#include "experiments/studies/precision/contest_figure.h"
#include "experiments/studies/precision/peers.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

struct WorkPrecisionOptions {
  InputOptions input;
  double duration = 0;      // [s]
  double time_limit = 0.5;  // of one run, CPU seconds
  int repetitions = 5;
  std::string damping = "own";
  bool libraries = true;
  std::string methods;        // see methods_option
  std::string plots, output;  // folders; no output: nothing is written
  EarlierRun earlier;
};

void check(const WorkPrecisionOptions& options) {
  const auto positive = [](const char* option, double value) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(option, 0, text("is %g, expected a positive number of seconds", value));
  };
  positive("--duration", options.duration);
  positive("--time-limit", options.time_limit);
  if (options.repetitions < 1)
    throw InputError("--repetitions", 0, text("is %d, expected at least 1", options.repetitions));
  if (!options.output.empty() && !std::filesystem::is_regular_file(options.plots + "/work_precision.gp"))
    throw InputError(options.plots, 0,
                     "has no work_precision.gp, expected the folder of the gnuplot scripts (--plots)");
}

Json json_of(const ContestRun& run, bool library) {
  Json seconds = Json::array();
  for (double s : run.seconds) seconds.push_back(number(s));
  return {{library ? "tolerance" : "step", number(run.setting)},
          {"outcome", name(run.outcome)},
          {"compared", run.compared},
          {"errors", run.errors ? json_of(*run.errors) : Json()},
          {"median_seconds", number(run.median_seconds())},
          {"cpu_seconds", seconds},
          {"steps", run.steps},
          {"counts", json_of(run.counts)},
          {"equivalents", run.equivalents()}};
}

Json json_of(const ContestResult& result, const Json& files) {
  Json list = Json::array();
  for (const ContestSeries& s : result.series) {
    Json runs = Json::array();
    for (const ContestRun& run : s.runs) runs.push_back(json_of(run, s.contestant.library));
    list.push_back({{"name", s.contestant.name},
                    {"library", s.contestant.library},
                    {"limit", number(s.contestant.limit)},
                    {"runs", runs}});
  }
  return {{"duration", number(result.duration)},
          {"k0", number(result.k0)},
          {"set_up_seconds", number(result.set_up_seconds)},
          {"damping", result.designed ? "designed" : "own"},
          {"reference",
           {{"method", result.reference.method},
            {"error", json_of(result.reference.error)},
            {"check_method", reference_check},
            {"check", result.reference.check ? json_of(*result.reference.check) : Json()}}},
          {"contestants", list},
          {"provenance", provenance()},
          {"files", files}};
}

void print(const ContestResult& result, const Problem& problem) {
  std::cout << text("%s: %ld unknowns, %g s; k0 = %.10g 1/s² (%.3g CPU-seconds)\n\n", result.title.c_str(),
                    static_cast<long>(problem.start().x.size()), result.duration, result.k0,
                    result.set_up_seconds)
            << cheapest_table({result}) << '\n'
            << reference_table({result}) << '\n'
            << provenance() << '\n';
}

int run_work_precision(const CommonOptions& common, const WorkPrecisionOptions& options) {
  check(options);
  const std::vector<Method> methods = methods_of(options.methods);
  Subject subject(options.input);
  expect_no_contact(subject, "work-precision");
  print_mesh_notes(subject);
  print_size_warning(subject);
  Problem problem(title_of(options.input), std::move(subject), options.duration, common);
  if (options.damping == "designed") {
    expect_designable(problem.model());
    problem.design_damping();
  }
  if (!options.output.empty()) make_folder(options.output);
  Json settings{{"duration", options.duration},     {"damping", options.damping},
                {"time-limit", options.time_limit}, {"repetitions", options.repetitions},
                {"libraries", options.libraries},   {"seed", common.seed}};
  settings.update(method_settings(common, options.methods));
  Journal journal(options.output,
                  identity_of("work-precision", settings, contents_of(options.input, options.earlier.resume)),
                  options.earlier, common.quiet);
  const std::string missing = missing_peers();
  if (options.libraries && !missing.empty() && !common.quiet)
    std::cerr << "springstab: left out, for they were not found when this was built: " << missing << '\n';
  const ContestResult result =
      run_contest(problem, options.output.empty() ? "" : options.output + "/references",
                  {options.time_limit, options.repetitions, options.libraries, methods, {}}, common, journal);
  Json files = Json::array();
  if (!options.output.empty()) {
    const std::string base = options.output + "/work_precision";
    for (const std::string& file : write_contests({result}, {base, base}, options.plots))
      files.push_back(file);
  }

  if (common.json) {
    print_json(json_of(result, files));
  } else {
    print(result, problem);
  }
  if (std::cout.flush()) journal.finish();
  return done;
}

}  // namespace

Subcommand work_precision_command() {
  const auto o = std::make_shared<WorkPrecisionOptions>();
  return {
      .name = "work-precision",
      .title = "Error against run time of every method",
      .footer =
          "Every method runs with steps from its stability limit down, halved each time, and each library "
          "with\n"
          "tolerances from 0.1 down, until a run takes too long or is within 100 times the reference's own "
          "error.\n"
          "Errors are relative and mass-weighted, against a reference in closed form (linear systems) or by "
          "GSL's\n"
          "rk8pd at two tolerances. Where a limit is not known the ladder begins at 4/sqrt(k0). Linearized "
          "methods\n"
          "linearize every 8 steps; implicit Euler's conjugate gradients have the tolerances 1e-2, 1e-4 and "
          "1e-8.\n"
          "Choose a duration on which the motion is not chaotic: the reference then says how precise it is.\n"
          "Cost: CPU seconds, and passes over all springs or blocks (force evaluations, assemblies, "
          "products).\n"
          "JSON: reference {method, error}, contestants[] {name, library, limit, runs[]}, provenance, "
          "files.\n\n"
          "example: springstab work-precision --grid 16x16 --pin first-row --duration 0.1 --output "
          "precision\n"
          "         the same with --resume after Ctrl-C or a crash",
      .options = with_input(
          o->input,
          {Option("--duration", &o->duration, "time to simulate").needed().shown_as("[s]"),
           Option("--damping", &o->damping, "own, or designed: alpha fitted to each step; errors against own")
               .one_of({"own", "designed"})
               .with_default(),
           Option("--time-limit", &o->time_limit, "of one run; a contestant ends with the first above it")
               .shown_as("[CPU s]")
               .with_default(),
           Option("--repetitions", &o->repetitions, "timed runs, after one that is not").with_default(),
           methods_option(o->methods),
           Option("!--no-libraries", &o->libraries, "without SUNDIALS, GSL and Boost.odeint"),
           Option("--output", &o->output, "folder for the runs as CSV, the figure, and the reference")
               .shown_as("DIR"),
           plots_option(o->plots), resume_option(o->earlier), overwrite_option(o->earlier)}),
      .run = [o](const CommonOptions& common) { return run_work_precision(common, *o); }};
}

}  // namespace springstab
