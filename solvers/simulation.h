// The simulation loop: a method, a system, a given step, and a watch for divergence.
#pragma once

#include <functional>
#include <optional>

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
  double time = 0;                       // the sum of their h [s]
  StepStatus status = StepStatus::done;  // of the last step; diverged also when the watch said so
  long failures = 0;                     // steps that were discarded and taken again otherwise
};

/// Sees every good state, the first included; returning false stops the run.
using Observer = std::function<bool(const SimulationResult& so_far, const State<Vector>& state)>;

/// How to go on after a failed step, from the last good state.
struct NewPlan {
  double h;
  long steps;
  bool to_the_end;  // replaces the rest of the run; otherwise the failed step only, and the old h follows
};

/// Asked after a failed step (so_far.status says why) with the last good state. It may also change the
/// system, as when new damping goes with the new step. Nothing means to give up.
using StepPolicy = std::function<std::optional<NewPlan>(const SimulationResult& so_far,
                                                        const State<Vector>& state, double h)>;

/// Takes `steps` steps of h from `state`. After anything but `done` the state is the last good one: neither
/// non-finite nor implausible states reach the observer. With a policy a failed step is discarded (paper
/// §4, 2.3), the method forgets what it had linearized, and the run goes on with the new plan.
SimulationResult simulate(System& system, Stepper& stepper, double h, long steps, const EnergyWatch& watch,
                          State<Vector>& state, const Observer& observe = {}, const StepPolicy& policy = {});

}  // namespace springstab
