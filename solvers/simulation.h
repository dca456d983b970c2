// The simulation loop: a method, a system, a given step, and a watch for divergence.
//
//     const EnergyWatch watch{.gravity = 9.81, .mass = scene.total_free_mass()};
//     const auto until = [](const RunSoFar& run, const State<Vector>&) { return run.time < 0.05; };
//     const SimulationResult end = simulate(scene, *make_stepper(Rk4()), {1e-3, 100}, watch, state, until);
//     if (end.status == StepStatus::diverged) std::cerr << "diverged at " << end.failed_at << " s\n";
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/step_filter.h"
#include "solvers/stepper.h"
#include "solvers/system.h"

namespace springstab {

/// How a run goes on: `steps` steps of h. In a linearized method one linearization serves
/// `steps_per_linearization` of them; the others have no use for the number.
struct StepPlan {
  double h;  // [s]
  long steps;
  long steps_per_linearization = 1;
};

/// Tells divergence from motion by energy. In a passive system under constant gravity g the kinetic energy
/// obeys
///     √T(t) <= √E0 + g √(m/2) t =: √B(t),   E0 = kinetic plus elastic energy at the start,
/// since elastic energy is never negative, damping takes energy and gravity gives at most g √(2mT) of power.
/// A run that exceeds this speed `slack` times has diverged. (Stable linear steps may exceed the energy bound
/// themselves, near a double eigenvalue by a factor of hundreds; a diverging run grows without bound.)
/// The total energy never grows; a run that has gained `largest_gain` times B(t) is about to diverge. That
/// takes an evaluation of the energy, so it is asked at checkpoints only, and not at all where nothing limits
/// the gain. A linear system that is known to be unstable has `growth_rate` > 0, and √B(t) is multiplied by
/// exp(growth_rate t). With K' >= -κ the energy plus κ x'Mx obeys that for the rate √κ: E0 then holds κ
/// x0'Mx0, and the rate is that of the method's own steps, which need not be the same. A system that
/// `may_grow`, as far as is known, is not watched while its kinetic energy comes out of a potential energy
/// below zero: there it may grow as it likes, as long as it is finite.
struct EnergyWatch {
  double initial_energy = 0;  // E0 [J]
  double gravity = 0;         // g [m/s²]
  double mass = 0;            // m of all that moves [kg]
  double slack = 1e3;
  double initial_total = 0;  // kinetic plus potential energy at the start [J]
  double largest_gain = std::numeric_limits<double>::infinity();
  bool may_grow = false;
  double growth_rate = 0;  // [1/s]

  bool diverged(double kinetic_energy, double t) const;
  bool gained(double total_energy, double t) const;
  bool grows(double kinetic_energy, double potential_energy) const;

 private:
  double speed_bound(double t) const;  // √B(t) [√J]
};

struct SimulationResult {
  long steps = 0;                        // completed and kept
  double time = 0;                       // the sum of their h [s]
  StepStatus status = StepStatus::done;  // of the last step; diverged also when watch or filter said so
  double failed_at = 0;                  // time that the last failed step would have reached [s]
  long failures = 0;                     // steps that were discarded and taken again otherwise
};

/// A plan that is being carried out.
struct Stage {
  double start;  // [s]
  StepPlan plan;
  long done = 0;  // steps
};

/// Where a run stands: what it has done and what it does, the last stage for one step of the one before it.
struct RunSoFar : SimulationResult {
  std::vector<Stage> stages;
  bool at_checkpoint = true;  // then this and the state are all that it takes to go on
};

/// Where a run that carries out the plan begins.
RunSoFar start_of(const StepPlan& plan);

/// Sees every good state that it has not declined (UnseenUntil), the first included; returning false stops
/// the run. After a divergence that was undone, time is back at the last checkpoint.
using Observer = std::function<bool(const RunSoFar& so_far, const State<Vector>& state)>;

/// Asked before a step for the time before which the observer has no use for states [s]: steps of a
/// linearized method may then be taken together. Checkpoints are seen all the same, and the first state after
/// a divergence that was undone.
using UnseenUntil = std::function<double()>;

/// Asked after a failed step (so_far.status says why) with the state from which to go on. It may also change
/// the system, as when new damping goes with the new step. The plan replaces the rest of the run after a
/// divergence, and otherwise the failed step alone. Nothing means to give up.
using StepPolicy = std::function<std::optional<StepPlan>(const SimulationResult& so_far,
                                                         const State<Vector>& state, const StepPlan& failed)>;

/// Carries out the plan from the x and v of `state`. Checkpoints are taken at whole linearizations, at least
/// 16 steps apart, and at the end. After a divergence the run is back at the last of them (paper §4, 2.3: the
/// latest result is discarded): there it ends, or goes on, linearized anew, with what the policy plans. A
/// failed solve leaves the state as it was before the step. Where h changes, the stepper is told. Neither
/// non-finite nor implausible states reach the observer. A filter, unless null, has every state before the
/// watch has it; where it changes one, what the method carries begins anew; where it fails, the step has not
/// converged.
SimulationResult simulate(System& system, Stepper& stepper, const StepPlan& plan, const EnergyWatch& watch,
                          State<Vector>& state, const Observer& observe = {}, const StepPolicy& policy = {},
                          StepFilter* filter = nullptr, const UnseenUntil& unseen_until = {});

/// The same from a checkpoint that an observer saw, with the state it saw there and all it carries: goes on
/// to the same bits as if the run had not been interrupted, if system and policy are as they were.
SimulationResult resume_simulation(System& system, Stepper& stepper, RunSoFar run, const EnergyWatch& watch,
                                   State<Vector>& state, const Observer& observe = {},
                                   const StepPolicy& policy = {}, StepFilter* filter = nullptr,
                                   const UnseenUntil& unseen_until = {});

}  // namespace springstab
