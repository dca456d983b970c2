#include "analysis/limits/step_policy.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "analysis/limits/transient_growth.h"
#include "analysis/regions/amplification.h"

namespace springstab {
namespace {

constexpr double default_max_step = 0.01;  // [s], where nothing limits the step
constexpr double tight_watch = 3;          // times the speed that energy conservation allows
constexpr double tight_gain = 1;           // times the energy that all of that speed would be
constexpr double quick_tolerance = 1e-4;   // of k0 on the way: far below what the safety factor covers
constexpr Eigen::Index large = 30000;      // unknowns: from there on it is quick at the start, too
constexpr long patience = 20, progress = 10;
constexpr double hopeless = 1e-6;  // of the first step
constexpr double most_steps = 1e15;

// How fast a method's steps let these modes grow, which do so by themselves [1/s]. An implicit step is halved
// where its matrix is not positive definite.
double growth_of_steps(const Method& method, const std::vector<DampedMode>& modes, double h) {
  double rate = 0;
  for (long halved = 0; halved <= (method.info().implicit ? patience : 0); ++halved, h /= 2)
    for (const DampedMode& mode : modes) {
      const double x = h * mode.d, y = h * h * mode.k;
      double radius = 0;
      spectral_radius(method, {&x, 1}, {&y, 1}, {&radius, 1});
      if (std::isfinite(radius) && radius > 1) rate = std::max(rate, std::log(radius) / h);
    }
  return rate;
}

}  // namespace

StepChoice choose_step(const StiffestMode& k0, const MethodLimits& limits, const StepOptions& options) {
  if (options.step) return {options.step};
  if (!k0.converged) return {{}, NoStep::k0_not_converged};
  if (limits.status == LimitStatus::none) return {{}, NoStep::none_stable};
  if (limits.status == LimitStatus::unknown && !limits.recommended) return {{}, NoStep::not_known};
  if (!limits.recommended) return {options.max_step.value_or(default_max_step)};
  return {std::min(*limits.recommended, options.max_step.value_or(*limits.recommended))};
}

StepPlan plan_steps(const MethodInfo& method, double largest_step, double duration, double relinearize) {
  const auto count = [](double total, double part) {
    return std::max(1.0, std::ceil(total / part * (1 - 1e-12)));
  };
  const double linearizations = method.linearized ? count(duration, relinearize) : 1;
  const double steps = count(duration / linearizations, largest_step);
  const double h = duration / linearizations / steps;
  if (linearizations * steps > most_steps) {
    std::ostringstream message;
    message << duration << " s would take " << std::setprecision(3) << linearizations * steps << " steps of "
            << h << " s, expected at most 1e15";
    throw TooManySteps(message.str());
  }
  StepPlan plan{h, static_cast<long>(linearizations * steps)};
  if (method.linearized) plan.steps_per_linearization = static_cast<long>(steps);
  return plan;
}

EnergyWatch tightened(EnergyWatch watch, double growth) {
  watch.slack = std::clamp(growth, tight_watch, watch.slack);
  watch.largest_gain = tight_gain;  // a false alarm costs a shorter step, a late one the shape of the cloth
  return watch;
}

StepChooser::StepChooser(Model& model, StepOptions options)
    : model_(model),
      options_(std::move(options)),
      designed_(model.damping().kind == DampingModel::Kind::designed),
      decisions_{.relinearize = options_.relinearize} {}

StructureLimits StepChooser::limits_at(const State<Vector>& state, double k0_tolerance) const {
  Structure structure = model_.structure(state);
  if (designed_) structure.damping.kind = DampingModel::Kind::designed;
  return StructureLimits(std::move(structure), {.safety = options_.safety,
                                                .certify = false,
                                                .seed = options_.seed,
                                                .k0_tolerance = k0_tolerance,
                                                .definiteness = model_.is_linear()});
}

StepChoice StepChooser::choice(StructureLimits limits) const {
  return choose_step(limits.k0(), limits.limits(options_.method), options_);
}

void StepChooser::apply(const StepPlan& plan) {
  decisions_.h = plan.h;
  if (designed_) model_.set_alpha(designed_alpha(options_.method, plan.h, model_.damping().d0));
}

double StepChooser::first_tolerance() const {
  return model_.system().size() < large ? ArpackOptions().tolerance : quick_tolerance;
}

StiffestMode StepChooser::first_k0() {
  return limits_at(model_.initial_state(options_.seed), first_tolerance()).k0();
}

std::optional<StepPlan> StepChooser::first_plan(const StepChoice& choice, double k0) {
  if (!choice.step) return reason_ = choice.reason, std::nullopt;
  k0_ = k0;
  least_step_ = hopeless * std::min(*choice.step, options_.duration);
  const StepPlan plan =
      plan_steps(options_.method.info(), *choice.step, options_.duration, decisions_.relinearize);
  apply(plan);
  return plan;
}

std::optional<StepPlan> StepChooser::first_plan() {
  if (options_.step) return first_plan({options_.step}, 0);
  StructureLimits limits = limits_at(model_.initial_state(options_.seed), first_tolerance());
  const double k0 = limits.k0().value;
  return first_plan(choice(std::move(limits)), k0);
}

// Nothing is linearized where two numbers say the damping.
std::optional<StepPlan> StepChooser::first_plan(const StiffestMode& k0) {
  if (options_.step) return first_plan({options_.step}, k0.value);
  Structure structure{{}, model_.damping()};
  if (structure.damping.kind == DampingModel::Kind::general || options_.method.info().implicit_damping)
    structure = model_.structure(model_.initial_state(options_.seed));
  if (designed_) structure.damping.kind = DampingModel::Kind::designed;
  const StructureLimitsOptions options{.safety = options_.safety, .certify = false, .seed = options_.seed};
  return first_plan(choice(StructureLimits(std::move(structure), options, k0)), k0.value);
}

// Of the planned steps at the start. Not of what the safety factor allows for: there it has no bound.
double StepChooser::growth() const {
  const DampingModel& damping = model_.damping();
  if (damping.kind == DampingModel::Kind::general) return 1;
  return transient_growth(options_.method, {.k_max = k0_, .d0 = damping.d0, .alpha = damping.alpha},
                          decisions_.h);
}

bool StepChooser::allow_for_own_growth(const State<Vector>& start, EnergyWatch& watch) const {
  if (!model_.matrices()) return false;
  StructureLimits limits = limits_at(start, quick_tolerance);
  const std::vector<DampedMode> modes = limits.growing_modes();
  if (modes.empty()) return false;
  double fastest = 0;
  for (const DampedMode& mode : modes) fastest = std::max(fastest, mode.mu.real());
  watch.growth_rate = std::max(fastest, growth_of_steps(options_.method, modes, decisions_.h));
  const double kappa = std::max(-limits.k0().lowest.value_or(0), 0.0);
  watch.initial_energy += kappa * 2 * model_.system().kinetic_energy(start.x);
  return true;
}

EnergyWatch StepChooser::watch(const State<Vector>& start) {
  EnergyWatch watch = model_.energy_watch(start);
  const bool grows = allow_for_own_growth(start, watch);
  // Nothing could save the run of a linear system, and a stable step may let its energy grow for a while.
  return grows || options_.step || model_.is_linear() ? watch : tightened(watch, growth());
}

std::optional<StepPlan> StepChooser::after_divergence(double time, const State<Vector>& state) {
  if (options_.step || model_.is_linear()) return std::nullopt;
  auto& [h, relinearize, rollbacks, halved, in_a_row, last] = decisions_;
  double step = choice(limits_at(state, quick_tolerance)).step.value_or(h / 2);
  if (step >= h * (1 - 1e-9)) step = options_.method.info().linearized && relinearize > h ? h : h / 2;
  if (step < least_step_) return std::nullopt;
  if (options_.method.info().linearized) relinearize = std::max(relinearize / 2, step);
  ++rollbacks;
  const StepPlan plan = plan_steps(options_.method.info(), step, options_.duration - time, relinearize);
  apply(plan);
  return plan;
}

void StepChooser::limit_step(double most) {
  options_.max_step = std::min(most, options_.max_step.value_or(most));
}

StepPlan StepChooser::plan_rest(double time) {
  const double step = std::min(decisions_.h, options_.max_step.value_or(decisions_.h));
  const StepPlan plan =
      plan_steps(options_.method.info(), step, options_.duration - time, decisions_.relinearize);
  apply(plan);
  return plan;
}

void StepChooser::go_on(const StepDecisions& decisions, double alpha) {
  decisions_ = decisions;
  if (designed_) model_.set_alpha(alpha);
}

StepPolicy StepChooser::policy() {
  return [this](const SimulationResult& so_far, const State<Vector>& state,
                const StepPlan& failed) -> std::optional<StepPlan> {
    StepDecisions& d = decisions_;
    d.failures_in_a_row = so_far.steps - d.steps_at_last_failure < progress ? d.failures_in_a_row + 1 : 1;
    d.steps_at_last_failure = so_far.steps;
    if (d.failures_in_a_row > patience) return std::nullopt;
    switch (so_far.status) {
      case StepStatus::diverged:
        return after_divergence(so_far.time, state);
      case StepStatus::not_positive_definite:
        ++d.halved_steps;
        return StepPlan{failed.h / 2, 2};
      case StepStatus::not_converged:
      case StepStatus::done:
        break;
    }
    return std::nullopt;
  };
}

}  // namespace springstab
