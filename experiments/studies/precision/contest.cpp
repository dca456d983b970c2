#include "experiments/studies/precision/contest.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/command/enum_name.h"
#include "experiments/command/output.h"
#include "experiments/studies/precision/peers.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

constexpr long clock_interval_steps = 16;  // steps between looks at the clock
constexpr int most_settings = 30;          // a factor 2^30
constexpr double reference_margin = 100;
constexpr double rounding_level = 1e-6;  // above it growing errors are not rounding

Outcome outcome_of(StepStatus status) {
  switch (status) {
    case StepStatus::done:
      return Outcome::finished;
    case StepStatus::diverged:
      return Outcome::diverged;
    default:
      return Outcome::failed;
  }
}

Attempt attempt_method(Problem& problem, std::string_view method, double h, double time_limit) {
  const long steps = std::lround(problem.duration() / h), between = steps / trajectory_samples;
  problem.set_damping_for(method, h);
  Attempt attempt;
  attempt.trajectory.reserve(trajectory_samples + 1);
  bool in_time = true;
  const double before = cpu_seconds();
  const MeasuredRun run =
      measured_run(problem.system(), method, {h, steps, contest_steps_per_linearization}, problem.watch(),
                   problem.start(), [&](const SimulationResult& so_far, const State<Vector>& state) {
                     if (so_far.steps % between == 0) attempt.trajectory.push_back(state);
                     if (so_far.steps % clock_interval_steps == 0)
                       in_time = cpu_seconds() - before <= time_limit;
                     return in_time;
                   });
  attempt.outcome = in_time ? outcome_of(run.result.status) : Outcome::timed_out;
  attempt.steps = run.result.steps;
  attempt.counts = run.counts;
  attempt.seconds = run.cpu_seconds;
  return attempt;
}

// Whole multiples of the samples.
double step_of(const Problem& problem, double multiples) {
  return problem.duration() / (trajectory_samples * multiples);
}

std::vector<double> steps_for(Problem& problem, std::optional<double> limit) {
  const double sample = problem.duration() / trajectory_samples;
  std::vector<double> steps;
  double multiples = 1;
  if (limit && *limit > 0 && std::isfinite(*limit)) {
    const double above = std::floor(sample / (1.02 * *limit));
    if (above >= 1) steps.push_back(step_of(problem, above));
    multiples = std::max(1.0, std::ceil(sample / (0.99 * *limit)));
  } else if (!(limit && *limit > 0)) {
    const double stable = 2 / std::sqrt(problem.k0());
    multiples = std::max(1.0, std::ceil(sample / (2 * stable)));
  }
  for (int i = 0; i < most_settings; ++i) steps.push_back(step_of(problem, multiples * std::ldexp(1., i)));
  return steps;
}

bool rounding_shows(const std::vector<ContestRun>& runs) {
  if (runs.size() < 2) return false;
  const std::optional<Errors>&last = runs.back().errors, &before = runs[runs.size() - 2].errors;
  return last && before && before->trajectory < rounding_level && last->trajectory > before->trajectory;
}

Json json_of(const ContestRun& run) {
  return {{"setting", run.setting},   {"outcome", static_cast<int>(run.outcome)},
          {"compared", run.compared}, {"errors", run.errors ? json_of(*run.errors) : Json()},
          {"steps", run.steps},       {"counts", json_of(run.counts)},
          {"seconds", run.seconds}};
}

ContestRun contest_run_of(const Json& json) {
  ContestRun run{.setting = json.at("setting"),
                 .outcome = static_cast<Outcome>(json.at("outcome").get<int>()),
                 .compared = json.at("compared"),
                 .errors = std::nullopt,
                 .steps = json.at("steps"),
                 .counts = counts_of(json.at("counts")),
                 .seconds = json.at("seconds")};
  if (const Json& e = json.at("errors"); !e.is_null())
    run.errors = {e.at("position"), e.at("velocity"), e.at("trajectory"), e.at("energy")};
  return run;
}

class Climb {
 public:
  Climb(Problem& problem, const Reference& reference, const ContestOptions& options, Journal& journal)
      : problem_(problem), reference_(reference), options_(options), journal_(journal) {}

  std::vector<ContestRun> operator()(const Contestant& contestant) {
    std::vector<ContestRun> runs;
    for (double setting : contestant.settings) {
      runs.push_back(contest_run_of(journal_.piece(contestant.name + text(" at %.17g", setting),
                                                   [&] { return json_of(run(contestant, setting)); })));
      const ContestRun& last = runs.back();
      if (last.outcome == Outcome::timed_out || rounding_shows(runs)) break;
      if (last.outcome == Outcome::finished && !last.compared) break;
    }
    return runs;
  }

 private:
  ContestRun run(const Contestant& contestant, double setting) {
    const Attempt first = contestant.attempt(setting, options_.time_limit);  // also the warm-up
    ContestRun run;
    run.setting = setting;
    run.outcome = first.outcome;
    run.steps = first.steps;
    run.counts = first.counts;
    run.seconds = {first.seconds};
    if (run.outcome != Outcome::finished) return run;
    problem_.set_own_damping();
    run.errors = errors_of(problem_.system(), first.trajectory, reference_.trajectory);
    if (!run.errors->all_finite()) {
      run.outcome = Outcome::diverged;
      run.errors.reset();
      return run;
    }
    run.compared = run.errors->trajectory >= reference_margin * reference_.error.trajectory;
    if (!run.compared) return run;
    run.seconds.clear();
    for (int i = 0; i < options_.repetitions; ++i)
      run.seconds.push_back(contestant.attempt(setting, 2 * options_.time_limit).seconds);
    return run;
  }

  Problem& problem_;
  const Reference& reference_;
  const ContestOptions& options_;
  Journal& journal_;
};

}  // namespace

const char* name(Outcome outcome) {
  static constexpr std::pair<Outcome, const char*> names[] = {{Outcome::finished, "finished"},
                                                              {Outcome::diverged, "diverged"},
                                                              {Outcome::timed_out, "timed-out"},
                                                              {Outcome::failed, "failed"}};
  return name_in(names, outcome);
}

Json json_of(const Errors& e) {
  return {{"position", number(e.position)},
          {"velocity", number(e.velocity)},
          {"trajectory", number(e.trajectory)},
          {"energy", number(e.energy)}};
}

double ContestRun::median_seconds() const {
  std::vector<double> sorted = seconds;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  return n % 2 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

const ContestSeries& ContestResult::of(const std::string& name) const {
  for (const ContestSeries& s : series)
    if (s.contestant.name == name) return s;
  throw std::invalid_argument("no contestant is called " + name);
}

std::vector<Contestant> method_contestants(Problem& problem, const std::vector<Method>& methods) {
  std::vector<Contestant> contestants;
  for (const Method& each : methods) {
    const std::optional<double> limit = problem.limit(each.name());
    const std::string method(each.name());
    const bool iterates = each.info().implicit && problem.scene();
    const bool precise = each.info().order > 1;  // a loose solve would hide it
    const std::vector<double> tolerances = !iterates ? std::vector{0.}
                                           : precise ? std::vector{1e-6}
                                                     : std::vector{1e-2, 1e-4, 1e-8};
    for (double tolerance : tolerances) {
      const std::string title(each.info().title);
      contestants.push_back({.name = iterates ? title + text(" (CG %g)", tolerance) : title,
                             .limit = limit,
                             .settings = steps_for(problem, limit),
                             .attempt = [&problem, method, tolerance](double h, double time_limit) {
                               if (tolerance > 0) problem.scene()->solver().tolerance = tolerance;
                               return attempt_method(problem, method, h, time_limit);
                             }});
    }
  }
  return contestants;
}

ContestResult run_contest(Problem& problem, const std::string& cache, const ContestOptions& options,
                          const CommonOptions& common, Journal& journal) {
  Progress progress(problem.title(), common.quiet);
  ContestResult result{.title = problem.title(),
                       .duration = problem.duration(),
                       .k0 = problem.k0(),
                       .set_up_seconds = problem.set_up_seconds(),
                       .designed = problem.is_designed(),
                       .reference = reference_motion(problem, cache, options.reference),
                       .options = options,
                       .series = {}};
  std::vector<Contestant> contestants = method_contestants(problem, options.methods);
  if (options.libraries && !problem.is_designed())  // libraries have no step to fit damping to
    for (Contestant& peer : peer_contestants(problem)) contestants.push_back(std::move(peer));
  Climb climb(problem, result.reference, options, journal);
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(contestants.size()));
    std::vector<ContestRun> runs = climb(contestants[i]);
    result.series.push_back({std::move(contestants[i]), std::move(runs)});
  }
  problem.set_own_damping();
  return result;
}

void write_runs(const std::string& path, const ContestResult& result) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "contestant,library,setting,limit,outcome,compared,error_position,error_velocity,error_trajectory,"
         "error_energy,reference_error,reference_check,median_seconds,least_seconds,most_seconds,steps,force_"
         "evaluations,"
         "hessian_assemblies,block_products,cg_iterations,equivalents\n";
  for (const ContestSeries& s : result.series)
    for (const ContestRun& run : s.runs) {
      out << '"' << s.contestant.name << "\"," << s.contestant.library << ',' << run.setting << ',';
      if (s.contestant.limit) out << *s.contestant.limit;
      out << ',' << name(run.outcome) << ',' << run.compared << ',';
      if (const auto& e = run.errors)
        out << e->position << ',' << e->velocity << ',' << e->trajectory << ',' << e->energy;
      else
        out << ",,,";
      const auto [least, most] = std::ranges::minmax(run.seconds);
      const Counts& c = run.counts;
      out << ',' << result.reference.error.trajectory << ',';
      if (const auto& check = result.reference.check) out << check->trajectory;
      out << ',' << run.median_seconds() << ',' << least << ',' << most << ',' << run.steps << ','
          << c.force_evaluations << ',' << c.hessian_assemblies << ',' << c.block_products << ','
          << c.cg_iterations << ',' << run.equivalents() << '\n';
    }
  file.commit();
}

Cheapest cheapest(const ContestResult& result, double wanted, bool libraries) {
  Cheapest best;
  for (const ContestSeries& s : result.series) {
    if (s.contestant.library != libraries) continue;
    for (const ContestRun& run : s.runs)
      if (run.compared && run.errors->trajectory <= wanted &&
          (!best.run || run.median_seconds() < best.run->median_seconds()))
        best = {&s.contestant, &run};
  }
  return best;
}

}  // namespace springstab
