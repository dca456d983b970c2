#include "experiments/step_chooser.h"

#include <algorithm>
#include <cmath>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/transient_growth.h"
#include "experiments/command/output.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr double default_max_step = 0.01;  // [s], where nothing limits the step
constexpr double tight_watch = 3;          // times the speed that energy conservation allows
constexpr double tight_gain = 1;           // times the energy that all of that speed would be
constexpr double quick_tolerance = 1e-4;   // of k0 on the way: far below what the safety factor covers
constexpr Eigen::Index large = 30000;      // unknowns: from there on it is quick at the start, too
constexpr long patience = 20, progress = 10;
constexpr double hopeless = 1e-6;  // of the first step

}  // namespace

EnergyWatch tightened(EnergyWatch watch, double growth) {
  watch.slack = std::clamp(growth, tight_watch, watch.slack);
  watch.largest_gain = tight_gain;  // a false alarm costs a shorter step, a late one the shape of the cloth
  return watch;
}

StepChooser::StepChooser(Subject& subject, const CommonOptions& common, const SimulateOptions& options)
    : subject_(subject),
      common_(common),
      options_(options),
      method_(options.method),
      designed_(subject.damping().kind == DampingModel::Kind::designed),
      relinearize_(options.relinearize) {}

StiffestMode StepChooser::k0_at(const State<Vector>& state, double tolerance) {
  return estimated_stiffest_mode(subject_.structure(state), {.tolerance = tolerance, .seed = common_.seed});
}

MethodLimits StepChooser::limits(const StiffestMode& k0, const State<Vector>& state) {
  DampingModel damping = subject_.damping();
  if (designed_) damping.kind = DampingModel::Kind::designed;
  if (damping.kind != DampingModel::Kind::general)
    return method_limits(method_, k0, damping, options_.safety);
  const StructuralMatrices structure = subject_.structure(state);
  return GeneralDamping(structure, k0, damping, options_.safety, false, {.seed = common_.seed})
      .limits(options_.method);
}

std::optional<double> StepChooser::recommended(const StiffestMode& k0, const State<Vector>& state) {
  if (!k0.converged) return reason_ = "k0 did not converge", std::nullopt;
  const MethodLimits limits = this->limits(k0, state);
  if (limits.status == LimitStatus::none)
    return reason_ = "no positive step of " + options_.method +
                     " is stable with this damping; choose another method (see springstab limits) or "
                     "--damping designed",
           std::nullopt;
  if (limits.status == LimitStatus::unknown && !limits.recommended)
    return reason_ = "the stable step of " + options_.method + " is not known for this damping; give --step",
           std::nullopt;
  if (!limits.recommended) return options_.max_step.value_or(default_max_step);
  return std::min(*limits.recommended, options_.max_step.value_or(*limits.recommended));
}

// A whole number of steps, and of linearizations, ends at the duration.
StepPlan StepChooser::plan(double largest_step, double duration) {
  const auto count = [](double total, double part) {
    return std::max(1.0, std::ceil(total / part * (1 - 1e-12)));
  };
  const double linearizations = method_.info().linearized ? count(duration, relinearize_) : 1;
  const double steps = count(duration / linearizations, largest_step);
  if (linearizations * steps > 1e15)
    throw InputError("--duration", 0,
                     text("%g s would take %.3g steps of %.3g s, expected at most 1e15", duration,
                          linearizations * steps, duration / linearizations / steps));
  StepPlan result{duration / linearizations / steps, static_cast<long>(linearizations * steps)};
  if (method_.info().linearized) result.steps_per_linearization = static_cast<long>(steps);
  if (designed_)
    subject_.set_alpha(designed_alpha(stability_region(options_.method), result.h, subject_.damping().d0));
  h_ = result.h;
  return result;
}

StiffestMode StepChooser::first_k0() {
  const double tolerance = subject_.system().size() < large ? 1e-10 : quick_tolerance;
  return k0_at(subject_.initial_state(common_.seed), tolerance);
}

std::optional<StepPlan> StepChooser::first_plan() {
  if (options_.step) return plan(*options_.step, options_.duration);
  return first_plan(first_k0());
}

std::optional<StepPlan> StepChooser::first_plan(const StiffestMode& k0) {
  const std::optional<double> step =
      options_.step ? options_.step : recommended(k0, subject_.initial_state(common_.seed));
  if (!step) return std::nullopt;
  k0_ = k0.value;
  least_step_ = hopeless * std::min(*step, options_.duration);
  return plan(*step, options_.duration);
}

// Of the planned steps at the start. Not of what the safety factor allows for: there it has no bound.
double StepChooser::growth() {
  const DampingModel damping = subject_.damping();
  if (damping.kind == DampingModel::Kind::general) return 1;
  return transient_growth(options_.method, {.k_max = k0_, .d0 = damping.d0, .alpha = damping.alpha}, h_);
}

EnergyWatch StepChooser::watch(const State<Vector>& start) {
  const EnergyWatch watch = subject_.energy_watch(start);
  return options_.step ? watch : tightened(watch, growth());
}

std::optional<StepPlan> StepChooser::after_divergence(double time, const State<Vector>& state) {
  if (options_.step || !subject_.scene()) return std::nullopt;
  double step = recommended(k0_at(state, quick_tolerance), state).value_or(h_ / 2);
  if (step >= h_ * (1 - 1e-9)) step = method_.info().linearized && relinearize_ > h_ ? h_ : h_ / 2;
  if (step < least_step_) return std::nullopt;
  if (method_.info().linearized) relinearize_ = std::max(relinearize_ / 2, step);
  ++rollbacks_;
  return plan(step, options_.duration - time);
}

Json StepChooser::kept() {
  return {{"h", h_},
          {"alpha", subject_.damping().alpha},
          {"relinearize", relinearize_},
          {"rollbacks", rollbacks_},
          {"halved_steps", halved_steps_},
          {"failures_in_a_row", failures_in_a_row_},
          {"steps_at_last_failure", steps_at_last_failure_}};
}

void StepChooser::go_on(const Json& kept) {
  h_ = kept.at("h");
  if (designed_) subject_.set_alpha(kept.at("alpha"));
  relinearize_ = kept.at("relinearize");
  rollbacks_ = kept.at("rollbacks");
  halved_steps_ = kept.at("halved_steps");
  failures_in_a_row_ = kept.at("failures_in_a_row");
  steps_at_last_failure_ = kept.at("steps_at_last_failure");
}

StepPolicy StepChooser::policy() {
  return [this](const SimulationResult& so_far, const State<Vector>& state,
                const StepPlan& failed) -> std::optional<StepPlan> {
    failures_in_a_row_ = so_far.steps - steps_at_last_failure_ < progress ? failures_in_a_row_ + 1 : 1;
    steps_at_last_failure_ = so_far.steps;
    if (failures_in_a_row_ > patience) return std::nullopt;
    switch (so_far.status) {
      case StepStatus::diverged:
        return after_divergence(so_far.time, state);
      case StepStatus::not_positive_definite:
        ++halved_steps_;
        return StepPlan{failed.h / 2, 2};
      case StepStatus::not_converged:
      case StepStatus::done:
        break;
    }
    return std::nullopt;
  };
}

}  // namespace springstab
