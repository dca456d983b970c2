// The simulation loop: a method, a system, a given step, and a watch for divergence.
#pragma once

#include <functional>

#include "solvers/stepper.h"
#include "solvers/system.h"

namespace springstab {

/// Tells divergence from motion by energy. In a passive system under constant gravity g the kinetic energy
/// obeys
///     √T(t) <= √E0 + g √(m/2) t,   E0 = kinetic plus elastic energy at the start,
/// since elastic energy is never negative, damping takes energy and gravity gives at most g √(2mT) of power.
/// A run that exceeds this speed `slack` times has diverged. (Stable linear steps may exceed the energy bound
/// themselves, near a double eigenvalue by a factor of hundreds; a diverging run grows without bound.)
struct EnergyWatch {
  double initial_energy = 0;  // E0 [J]
  double gravity = 0;         // g [m/s²]
  double mass = 0;            // m of all that moves [kg]
  double slack = 1e3;

  bool diverged(double kinetic_energy, double t) const;
};

struct SimulationResult {
  long steps = 0;                        // completed
  double time = 0;                       // steps · h [s]
  StepStatus status = StepStatus::done;  // of the last step; diverged also when the watch said so
};

/// Takes `steps` steps of h from `state`. `observe(step, state)` is called for step 0 and after every
/// completed step, and stops the run by returning false. After anything but `done` the state is the last good
/// one: not finite or not plausible states never reach the observer.
SimulationResult simulate(System& system, Stepper& stepper, double h, long steps, const EnergyWatch& watch,
                          State<Vector>& state,
                          const std::function<bool(long step, const State<Vector>&)>& observe = {});

}  // namespace springstab
