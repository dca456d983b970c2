#include "solvers/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springstab {
namespace {

constexpr long least_checkpoint_distance = 16;  // steps

double time_of(const Stage& stage, long step) {
  return stage.start + static_cast<double>(step) * stage.plan.h;
}

// At whole linearizations, and at the end.
bool at_checkpoint(const StepPlan& plan, long step) {
  const long each = plan.steps_per_linearization;
  const long distance = (least_checkpoint_distance + each - 1) / each * each;
  return step == plan.steps || step % distance == 0;
}

/// Where a run goes back to.
struct Checkpoint {
  State<Vector> state;
  long steps = 0;
  double time = 0;
  double h = 0;  // for which the state carries what it does

  void keep(const State<Vector>& good, double h_of_good, const SimulationResult& so_far) {
    state = good;  // into the memory it has
    h = h_of_good;
    steps = so_far.steps;
    time = so_far.time;
  }
};

/// Steps taken together, of which nobody looks at any but the last. What the watch would object to is left to
/// steps one by one.
class UnseenSteps {
 public:
  UnseenSteps(const Observer& observe, const UnseenUntil& unseen_until, const EnergyWatch& watch)
      : observe_(observe), unseen_until_(unseen_until), watch_(watch) {}

  /// How many it took, from where the stage is; if none, the next one is to be taken by itself.
  long take(System& system, Stepper& stepper, const Stage& stage, State<Vector>& state) {
    if (one_by_one_ > 0) {
      --one_by_one_;
      return 0;
    }
    const long most = steps_to_look(stage);
    const long taken =
        most < 2
            ? 0
            : stepper.take_steps(system, stage.plan.h, most, state, [&, this](long step, double kinetic) {
                return !watch_.diverged(kinetic * (1 + rounding), time_of(stage, stage.done + step));
              });
    if (taken == 0) one_by_one_ = most - 1;
    return taken;
  }

  /// The next step is by itself.
  void pause() { one_by_one_ = 1; }

 private:
  static constexpr double rounding = 1e-6;  // of a sum

  // To a checkpoint, or to a time at which the observer looks.
  long steps_to_look(const Stage& stage) const {
    constexpr double forever = std::numeric_limits<double>::infinity();
    const double until = !observe_ ? forever : unseen_until_ ? unseen_until_() : -forever;
    long step = stage.done + 1;
    while (!at_checkpoint(stage.plan, step) && time_of(stage, step) < until) ++step;
    return step - stage.done;
  }

  const Observer& observe_;
  const UnseenUntil& unseen_until_;
  const EnergyWatch& watch_;
  long one_by_one_ = 0;
};

// A step to the time t, and the filter. `before` is workspace.
StepStatus filtered_step(System& system, Stepper& stepper, StepFilter& filter, double t, double h,
                         State<Vector>& before, State<Vector>& state) {
  before.x = state.x;
  before.v = state.v;
  const StepStatus status = stepper.step(system, h, state);
  if (status != StepStatus::done) return status;
  const Filtered filtered = filter.apply(t, h, before, state);
  if (filtered == Filtered::outgrown) return StepStatus::diverged;
  if (filtered == Filtered::failed) {
    state.x = before.x;
    state.v = before.v;
  }
  if (filtered != Filtered::unchanged && !state.memory.empty()) stepper.start(system, h, state);
  return filtered == Filtered::failed ? StepStatus::not_converged : StepStatus::done;
}

}  // namespace

double EnergyWatch::speed_bound(double t) const {
  const double passive = std::sqrt(std::max(initial_energy, 0.)) + gravity * std::sqrt(mass / 2) * t;
  return growth_rate > 0 ? passive * std::exp(growth_rate * t) : passive;
}

bool EnergyWatch::diverged(double kinetic_energy, double t) const {
  return !(std::isfinite(kinetic_energy) && std::sqrt(kinetic_energy) <= slack * speed_bound(t));
}

bool EnergyWatch::gained(double total_energy, double t) const {
  return !(total_energy - initial_total <= largest_gain * speed_bound(t) * speed_bound(t));
}

bool EnergyWatch::grows(double kinetic_energy, double potential_energy) const {
  return (may_grow || growth_rate > 0) && potential_energy < -kinetic_energy / 2;
}

RunSoFar start_of(const StepPlan& plan) {
  RunSoFar run;
  run.stages = {{0, plan}};
  return run;
}

SimulationResult simulate(System& system, Stepper& stepper, const StepPlan& plan, const EnergyWatch& watch,
                          State<Vector>& state, const Observer& observe, const StepPolicy& policy,
                          StepFilter* filter, const UnseenUntil& unseen_until) {
  stepper.start(system, plan.h, state);
  return resume_simulation(system, stepper, start_of(plan), watch, state, observe, policy, filter,
                           unseen_until);
}

SimulationResult resume_simulation(System& system, Stepper& stepper, RunSoFar run, const EnergyWatch& watch,
                                   State<Vector>& state, const Observer& observe, const StepPolicy& policy,
                                   StepFilter* filter, const UnseenUntil& unseen_until) {
  std::vector<Stage>& stages = run.stages;
  double h = stages.back().plan.h;  // for which the state carries what it does
  Checkpoint checkpoint{state, run.steps, run.time, h};
  State<Vector> before;  // the step that is filtered
  UnseenSteps together(observe, unseen_until, watch);
  stepper.restart(stages.back().plan.steps_per_linearization);
  if (observe && !observe(run, state)) return static_cast<SimulationResult&&>(run);
  const auto has_diverged = [&](double t) {
    const double kinetic = system.kinetic_energy(state.v);
    const bool fast = watch.diverged(kinetic, t);
    if (!fast && !(run.at_checkpoint && std::isfinite(watch.largest_gain))) return false;
    const double potential = system.potential_energy(state.x);
    return !watch.grows(kinetic, potential) && (fast || watch.gained(kinetic + potential, t));
  };
  while (!stages.empty()) {
    Stage& stage = stages.back();
    if (stage.done == stage.plan.steps) {
      stages.pop_back();
      if (!stages.empty()) ++stages.back().done;
      continue;
    }
    if (h != stage.plan.h) stepper.change_step(system, h, stage.plan.h, state);
    h = stage.plan.h;
    const long taken = filter ? 0 : together.take(system, stepper, stage, state);
    stage.done += std::max(taken - 1, 0L);
    run.steps += std::max(taken - 1, 0L);
    const double t = time_of(stage, stage.done + 1);
    run.status = filter      ? filtered_step(system, stepper, *filter, t, h, before, state)
                 : taken > 0 ? StepStatus::done
                             : stepper.step(system, h, state);
    if (run.status == StepStatus::done) {
      ++stage.done;
      run.at_checkpoint = at_checkpoint(stage.plan, stage.done);
      if (has_diverged(t)) {
        run.status = StepStatus::diverged;
      } else {
        ++run.steps;
        run.time = t;
        if (run.at_checkpoint) checkpoint.keep(state, h, run);
        if (observe && !observe(run, state)) break;
        continue;
      }
    }
    run.failed_at = t;
    const bool diverged = run.status == StepStatus::diverged;
    if (diverged) {
      state = checkpoint.state;
      h = checkpoint.h;
      run.steps = checkpoint.steps;
      run.time = checkpoint.time;
      together.pause();
    }
    const std::optional<StepPlan> next = policy ? policy(run, state, stage.plan) : std::nullopt;
    if (!next) break;
    ++run.failures;
    if (diverged) stages.clear();
    stages.push_back({run.time, *next});
    stepper.restart(next->steps_per_linearization);
  }
  return static_cast<SimulationResult&&>(run);
}

}  // namespace springstab
