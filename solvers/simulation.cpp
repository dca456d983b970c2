#include "solvers/simulation.h"

#include <cmath>

namespace springstab {

bool EnergyWatch::diverged(double kinetic_energy, double t) const {
  const double bound = std::sqrt(initial_energy) + gravity * std::sqrt(mass / 2) * t;
  return !(std::sqrt(kinetic_energy) <= slack * bound);
}

SimulationResult simulate(System& system, Stepper& stepper, double h, long steps, const EnergyWatch& watch,
                          State<Vector>& state,
                          const std::function<bool(long step, const State<Vector>&)>& observe) {
  SimulationResult result;
  State<Vector> last_good = state;
  if (observe && !observe(0, state)) return result;
  while (result.steps < steps) {
    result.status = stepper.step(system, h, state);
    const double t = static_cast<double>(result.steps + 1) * h;
    if (result.status == StepStatus::done && watch.diverged(system.kinetic_energy(state.v), t)) {
      result.status = StepStatus::diverged;
      state = last_good;
    }
    if (result.status != StepStatus::done) break;
    last_good = state;
    ++result.steps;
    result.time = t;
    if (observe && !observe(result.steps, state)) break;
  }
  return result;
}

}  // namespace springstab
