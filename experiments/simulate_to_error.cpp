#include "experiments/simulate_to_error.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "experiments/cheapest_report.h"
#include "experiments/command/shared_options.h"
#include "experiments/runs/step_run.h"
#include "solvers/io/input_error.h"
#include "solvers/simulation.h"

namespace springstab {
namespace {

constexpr double unlimited_step = 0.01;  // where nothing limits the step [s]
constexpr double margin = 0.9;           // of the step that the first estimate asks for
constexpr double least_factor = 1e-3;    // between the steps of the two runs

double time_of_sample(double duration, std::size_t i) {
  return duration * static_cast<double>(i) / static_cast<double>(error_samples);
}

}  // namespace

void check_error_options(const SimulateOptions& options, const CommonOptions& common) {
  if (!options.error) {
    if (options.method.empty()) throw InputError("--method", 0, "is required, unless --error chooses it");
    if (!options.methods.empty()) throw InputError("--methods", 0, "is for --error, expected --method");
    return;
  }
  check_error(options.error);
  if (options.step) throw InputError("--step", 0, "stands beside --error, which chooses the step");
  if (!options.method.empty() && !options.methods.empty())
    throw InputError("--method, --methods", 0, "are both given, expected one of them");
  if (common.given.contains("--resume"))
    throw InputError("--resume", 0, "stands beside --error, expected the --method and --max-step it chose");
}

ErrorRun::ErrorRun(const CommonOptions& common, const SimulateOptions& options, Subject& subject)
    : common_(common),
      options_(options),
      subject_(subject),
      designed_(subject.damping().kind == DampingModel::Kind::designed) {
  const std::vector<Method> methods =
      options.method.empty() ? methods_of(options.methods) : std::vector<Method>{options.method};
  const State<Vector> start = subject.initial_state(common.seed);
  StructureLimits limits(subject.structure(start), {.safety = options.safety,
                                                    .certify = false,
                                                    .seed = common.seed,
                                                    .max_step = options.max_step.value_or(unlimited_step),
                                                    .definiteness = subject.is_linear()});
  const CheapestOptions asked{
      .error = options.error, .duration = options.duration, .relinearize = options.relinearize};
  std::optional<Waiting> waiting(std::in_place, "choosing method and step", common.quiet);
  const CheapestMethod cheapest(limits, subject, start, methods, asked);
  waiting.reset();
  reason_ = reason(cheapest, asked);
  const MethodCost* const best = cheapest.best();
  if (!best) {
    no_choice_ = limits.k0().converged ? reason_ : "k0 did not converge";
    return;
  }
  options_.method = best->method.name();
  options_.max_step = std::min(best->step, options.max_step.value_or(best->step));
  predicted_ = best->error;
}

// After a divergence that was undone the run is back at an earlier time.
void ErrorRun::see(double time, const State<Vector>& state) {
  while (!samples_.empty() && samples_.back().time > time) samples_.pop_back();
  if (time >= unseen_until()) samples_.push_back({time, state.x});
}

double ErrorRun::unseen_until() const {
  if (samples_.size() >= static_cast<std::size_t>(error_samples))
    return std::numeric_limits<double>::infinity();
  return time_of_sample(options_.duration, samples_.size() + 1) * (1 - 1e-9);
}

// The second run, with the damping of the first. Nothing where it does not finish.
std::optional<double> ErrorRun::difference(const State<Vector>& start, double h,
                                           const StopOnInterrupt& interrupt) {
  StepOptions options = step_options(common_, options_);
  options.step = check_step_ = h / 2;
  options.relinearize /= 2;
  StepChooser chooser(subject_, options);
  const StepPlan plan = *chooser.first_plan();
  check_step_ = plan.h;
  System& system = subject_.system();
  double wrong = 0, moved = 0;
  std::size_t next = 0;
  State<Vector> state = start;
  Progress progress("estimating the error", common_.quiet);
  const auto next_time = [&] {
    return next < samples_.size() ? samples_[next].time * (1 - 1e-9)
                                  : std::numeric_limits<double>::infinity();
  };
  const auto result = simulate(
      system, *chooser.method().stepper(), plan, chooser.watch(start), state,
      [&](const RunSoFar& so_far, const State<Vector>& s) {
        if (so_far.time >= next_time()) {
          wrong += system.kinetic_energy(samples_[next].x - s.x);
          moved += system.kinetic_energy(s.x - start.x);
          ++next;
        }
        if (so_far.at_checkpoint) progress.update(so_far.time / options_.duration);
        return !interrupt.requested();
      },
      chooser.policy(), nullptr, next_time);
  if (result.status != StepStatus::done || next < samples_.size()) return std::nullopt;
  return wrong > 0 ? std::sqrt(wrong / moved) : 0;
}

bool ErrorRun::is_to_repeat(const State<Vector>& start, double h, const StopOnInterrupt& interrupt) {
  ++runs_;
  const int order = Method(options_.method).info().order;
  estimate_.reset();
  if (const std::optional<double> away = difference(start, h, interrupt); away && std::isfinite(*away))
    estimate_ = *away / (1 - std::pow(2.0, -order));
  samples_.clear();
  if (!estimate_ || !missed() || runs_ > 1) return false;
  const double factor = std::max(least_factor, margin * std::pow(*options_.error / *estimate_, 1.0 / order));
  const double steps = std::ceil(options_.duration / (error_samples * h * factor));
  options_.max_step = options_.duration / (error_samples * steps);
  options_.relinearize *= factor;
  if (designed_) subject_.design_damping();
  std::cerr << text(
      "springstab: note: an error of %.3g was estimated, not %g: once more with steps of %.6g s\n",
      *estimate_, *options_.error, *options_.max_step);
  return true;
}

Json ErrorRun::json() const {
  return {{"wanted", number(options_.error)},
          {"estimated", number(estimate_)},
          {"status", !estimate_ ? "unknown"
                     : missed() ? "missed"
                                : "reached"},
          {"predicted", number(predicted_)},
          {"second_step", check_step_ > 0 ? Json(check_step_) : Json()},
          {"runs", runs_},
          {"reason", reason_}};
}

std::string ErrorRun::text_of() const {
  std::string all =
      "chosen for an error of " + text("%g: ", *options_.error) + options_.method + ", " + reason_ + '\n';
  all += estimate_
             ? text("estimated error %.3g, from a second run with steps of %.6g s", *estimate_, check_step_)
             : "error not known: no second run at half the step finished";
  if (estimate_ && missed()) all += ": missed";
  if (runs_ > 1) all += text("; this is run %d", runs_);
  return all + '\n';
}

}  // namespace springstab
