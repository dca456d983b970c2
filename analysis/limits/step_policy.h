// Which step a run takes: at the start from the limits, and anew when a step fails.
//
//     StepChooser chooser(model, {.method = "linearized-explicit-euler", .duration = 1});
//     const StepPlan plan = chooser.first_plan().value();
//     State<Vector> state = model.initial_state();
//     const EnergyWatch watch = chooser.watch(state);
//     simulate(model.system(), *chooser.method().stepper(), plan, watch, state, {}, chooser.policy());
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>

#include "analysis/method.h"
#include "analysis/model.h"
#include "analysis/structure_limits.h"
#include "solvers/simulation.h"

namespace springstab {

struct StepOptions {
  Method method;
  double duration = 0;               // of the run [s]
  std::optional<double> step{};      // kept, come what may [s]
  std::optional<double> max_step{};  // [s]
  double safety = 1.5;               // on the stiffness
  double relinearize = 0.01;         // h_m of the linearized methods [s]
  std::uint64_t seed = 1;
};

/// Why there is no step to take.
enum class NoStep {
  k0_not_converged,
  none_stable,  // no positive step is, with this damping
  not_known     // for this kind of damping
};

/// The step from which to plan, or why there is none.
struct StepChoice {
  std::optional<double> step;  // [s]
  NoStep reason{};             // where there is none
};

/// The recommended step, or the given one, at most max_step; 0.01 s where nothing limits it.
StepChoice choose_step(const StiffestMode& k0, const MethodLimits& limits, const StepOptions& options);

/// More than 1e15 steps.
struct TooManySteps : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Equal steps, none longer than `largest_step` [s], that end at the duration [s]; of a linearized method
/// with a whole number of linearizations, none older than `relinearize` [s]. Throws TooManySteps.
StepPlan plan_steps(const MethodInfo& method, double largest_step, double duration, double relinearize);

/// The watch of a run that can be saved: it fires at three times the speed that energy conservation allows,
/// or at `growth` times if stable steps may let it grow that far before it decays, and at a gain of all the
/// energy of the allowed speed.
EnergyWatch tightened(EnergyWatch watch, double growth = 1);

/// What a chooser has decided so far.
struct StepDecisions {
  double h = 0;            // [s]
  double relinearize = 0;  // h_m [s]
  long rollbacks = 0, halved_steps = 0;
  long failures_in_a_row = 0, steps_at_last_failure = -1;
};

/// The paper's rule made a policy. A step that the user gave is kept, come what may. Otherwise the step is
/// the recommended one, and a divergence that the watch sees is undone: the run is back at its last
/// checkpoint, k0 is computed for the state there, and the step (and designed damping) chosen for it. A
/// linearized method also linearizes twice as often from there on, since frozen forces lead away from the
/// true ones; where neither has shortened anything, the step is halved. When 1 + hD' + h²K' is not positive
/// definite, the step is taken as two halves (paper §5.2). It gives up after 20 failures within 10
/// steps' progress, and when a step a millionth of the first one does not help: then the motion itself grows
/// without bound, as where springs are compressed and damping αK takes no energy but gives it.
class StepChooser {
 public:
  /// The model must outlive it.
  StepChooser(Model& model, StepOptions options);

  const Method& method() const { return options_.method; }

  /// Applies what it plans. Nothing where there is no stable step or none is known; reason() then says which.
  std::optional<StepPlan> first_plan();
  /// k0 of the start, estimated; of a large system no more precisely than the safety factor needs.
  StiffestMode first_k0();
  /// The same plan for a k0 that is known already.
  std::optional<StepPlan> first_plan(const StiffestMode& k0);
  NoStep reason() const { return reason_; }

  /// Gives the model the alpha that belongs to the plan's step, where alpha was left to the design.
  void apply(const StepPlan& plan);

  /// Tight where there is a policy to save the run, wide where a fixed step decides. Of an unstable linear
  /// system it allows for the growth of the motions that grow by themselves, as this method steps them.
  EnergyWatch watch(const State<Vector>& start);

  /// No longer step from the next plan on.
  void limit_step(double most);
  /// Applies and gives a plan for the rest of the run from `time` on, where what limits it has changed.
  StepPlan plan_rest(double time);

  /// For simulate(); refers to this object.
  StepPolicy policy();

  const StepDecisions& decisions() const { return decisions_; }
  /// Brings a chooser that has planned the same first step to where another one was, with this alpha.
  void go_on(const StepDecisions& decisions, double alpha);

 private:
  StructureLimits limits_at(const State<Vector>& state, double k0_tolerance) const;
  StepChoice choice(StructureLimits limits) const;
  std::optional<StepPlan> first_plan(const StepChoice& choice, double k0);
  double first_tolerance() const;
  double growth() const;
  bool allow_for_own_growth(const State<Vector>& start, EnergyWatch& watch) const;
  std::optional<StepPlan> after_divergence(double time, const State<Vector>& state);

  Model& model_;
  StepOptions options_;
  bool designed_;
  NoStep reason_{};
  double k0_ = 0;          // that of the first plan [1/s²]; 0 where it was not needed
  double least_step_ = 0;  // [s]
  StepDecisions decisions_;
};

}  // namespace springstab
