#include "solvers/simulation.h"

#include <cmath>
#include <vector>

namespace springstab {
namespace {

constexpr long least_checkpoint_distance = 16;  // steps

/// A plan that is being carried out.
struct Stage {
  double start;  // [s]
  StepPlan plan;
  long done = 0;
  long checkpoint_distance = whole_linearizations(plan);

  double time_of(long step) const { return start + static_cast<double>(step) * plan.h; }
  bool at_checkpoint() const { return done == plan.steps || done % checkpoint_distance == 0; }

  static long whole_linearizations(const StepPlan& plan) {
    const long each = plan.steps_per_linearization;
    return (least_checkpoint_distance + each - 1) / each * each;
  }
};

/// Where a run goes back to.
struct Checkpoint {
  State<Vector> state;
  long steps = 0;
  double time = 0;

  void keep(const State<Vector>& good, const SimulationResult& so_far) {  // into the memory it has
    state.x = good.x;
    state.v = good.v;
    steps = so_far.steps;
    time = so_far.time;
  }
};

}  // namespace

bool EnergyWatch::diverged(double kinetic_energy, double t) const {
  if (initial_energy < 0) return !std::isfinite(kinetic_energy);
  const double bound = std::sqrt(initial_energy) + gravity * std::sqrt(mass / 2) * t;
  return !(std::sqrt(kinetic_energy) <= slack * bound);
}

bool EnergyWatch::gained(double total_energy, double t) const {
  if (initial_energy < 0) return false;
  const double bound = std::sqrt(initial_energy) + gravity * std::sqrt(mass / 2) * t;
  return !(total_energy - initial_total <= largest_gain * bound * bound);
}

SimulationResult simulate(System& system, Stepper& stepper, const StepPlan& plan, const EnergyWatch& watch,
                          State<Vector>& state, const Observer& observe, const StepPolicy& policy) {
  std::vector<Stage> stages{{0, plan}};  // the last one is carried out, for one step of the one before it
  SimulationResult result;
  Checkpoint checkpoint{state};
  stepper.restart(plan.steps_per_linearization);
  if (observe && !observe(result, state)) return result;
  const auto gained = [&](double t) {
    return std::isfinite(watch.largest_gain) &&
           watch.gained(system.kinetic_energy(state.v) + system.potential_energy(state.x), t);
  };
  while (!stages.empty()) {
    Stage& stage = stages.back();
    if (stage.done == stage.plan.steps) {
      stages.pop_back();
      if (!stages.empty()) ++stages.back().done;
      continue;
    }
    const double t = stage.time_of(stage.done + 1);
    result.status = stepper.step(system, stage.plan.h, state);
    if (result.status == StepStatus::done) {
      ++stage.done;
      const bool is_checkpoint = stage.at_checkpoint();
      if (watch.diverged(system.kinetic_energy(state.v), t) || (is_checkpoint && gained(t))) {
        result.status = StepStatus::diverged;
      } else {
        ++result.steps;
        result.time = t;
        if (is_checkpoint) checkpoint.keep(state, result);
        if (observe && !observe(result, state)) break;
        continue;
      }
    }
    result.failed_at = t;
    const bool diverged = result.status == StepStatus::diverged;
    if (diverged) {
      state = checkpoint.state;
      result.steps = checkpoint.steps;
      result.time = checkpoint.time;
    }
    const std::optional<StepPlan> next = policy ? policy(result, state, stage.plan) : std::nullopt;
    if (!next) break;
    ++result.failures;
    if (diverged) stages.clear();
    stages.push_back({result.time, *next});
    stepper.restart(next->steps_per_linearization);
  }
  return result;
}

}  // namespace springstab
