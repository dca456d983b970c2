#include "solvers/simulation.h"

#include <cmath>
#include <vector>

namespace springstab {

bool EnergyWatch::diverged(double kinetic_energy, double t) const {
  const double bound = std::sqrt(initial_energy) + gravity * std::sqrt(mass / 2) * t;
  return !(std::sqrt(kinetic_energy) <= slack * bound);
}

SimulationResult simulate(System& system, Stepper& stepper, double h, long steps, const EnergyWatch& watch,
                          State<Vector>& state, const Observer& observe, const StepPolicy& policy) {
  struct Plan {
    double start, h;
    long steps, done = 0;
  };
  std::vector<Plan> plans{
      {0, h, steps}};  // the last one is being carried out, for one step of that before it
  SimulationResult result;
  State<Vector> last_good = state;
  if (observe && !observe(result, state)) return result;
  while (!plans.empty()) {
    Plan& plan = plans.back();
    if (plan.done == plan.steps) {
      plans.pop_back();
      if (!plans.empty()) ++plans.back().done;
      continue;
    }
    const double t = plan.start + static_cast<double>(plan.done + 1) * plan.h;
    result.status = stepper.step(system, plan.h, state);
    if (result.status == StepStatus::done && watch.diverged(system.kinetic_energy(state.v), t)) {
      result.status = StepStatus::diverged;
      state = last_good;
    }
    if (result.status == StepStatus::done) {
      last_good = state;
      ++plan.done;
      ++result.steps;
      result.time = t;
      if (observe && !observe(result, state)) break;
      continue;
    }
    const std::optional<NewPlan> next = policy ? policy(result, state, plan.h) : std::nullopt;
    if (!next) break;
    stepper.forget();
    ++result.failures;
    if (next->to_the_end) plans.clear();
    plans.push_back({result.time, next->h, next->steps});
  }
  return result;
}

}  // namespace springstab
