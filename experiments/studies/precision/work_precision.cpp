// `springstab work-precision`: error against run time on the user's own scene.
#include <cmath>
#include <filesystem>
#include <iostream>

#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/journal.h"
#include "experiments/studies/precision/contest.h"
#include "experiments/studies/precision/contest_figure.h"
#include "experiments/studies/precision/peers.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

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

std::string title_of(const InputOptions& input) {
  return !input.file.empty()   ? std::filesystem::path(input.file).stem().string()
         : !input.grid.empty() ? input.grid
                               : std::filesystem::path(input.stiffness).stem().string();
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

}  // namespace

int run_work_precision(const CommonOptions& common, const WorkPrecisionOptions& options) {
  check(options);
  Subject subject(options.input);
  print_mesh_notes(subject);
  Problem problem(title_of(options.input), std::move(subject), options.duration, common);
  if (options.designed_damping) {
    expect_designable(problem.model());
    problem.design_damping();
  }
  if (!options.output.empty()) make_folder(options.output);
  const Json settings{
      {"duration", options.duration},     {"damping", options.designed_damping ? "designed" : "own"},
      {"time-limit", options.time_limit}, {"repetitions", options.repetitions},
      {"libraries", options.libraries},   {"seed", common.seed}};
  Journal journal(options.output,
                  identity_of("work-precision", settings, contents_of(options.input, options.resume)),
                  options.resume, common.quiet);
  const std::string missing = missing_peers();
  if (options.libraries && !missing.empty() && !common.quiet)
    std::cerr << "springstab: left out, for they were not found when this was built: " << missing << '\n';
  const ContestResult result =
      run_contest(problem, options.output.empty() ? "" : options.output + "/references",
                  {options.time_limit, options.repetitions, options.libraries}, common, journal);
  Json files = Json::array();
  if (!options.output.empty())
    for (const std::string& file :
         write_contests({result}, options.output + "/work_precision", options.plots))
      files.push_back(file);

  if (common.json) {
    print_json(json_of(result, files));
  } else {
    print(result, problem);
  }
  if (std::cout.flush()) journal.finish();
  return done;
}

}  // namespace springstab
