// Which step a run takes: at the start from the limits, and anew when a step fails.
#pragma once

#include <optional>
#include <string>

#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/simulate_options.h"
#include "solvers/simulation.h"

namespace springstab {

/// The watch of a run that can be saved: it fires at three times the speed that energy conservation allows,
/// or at `growth` times if stable steps may let it grow that far before it decays, and at a gain of all the
/// energy of the allowed speed.
EnergyWatch tightened(EnergyWatch watch, double growth = 1);

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
  StepChooser(Subject& subject, const CommonOptions& common, const SimulateOptions& options);

  /// Nothing where there is no stable step or none is known; reason() then says which.
  std::optional<StepPlan> first_plan();
  /// k0 of the start, estimated; of a large system no more precisely than the safety factor needs.
  StiffestMode first_k0();
  /// The same plan for a k0 that is known already.
  std::optional<StepPlan> first_plan(const StiffestMode& k0);
  const std::string& reason() const { return reason_; }

  /// Tight where there is a policy to save the run, wide where a fixed step decides.
  EnergyWatch watch(const State<Vector>& start);

  /// For simulate(); refers to this object.
  StepPolicy policy();

  /// What it has decided so far, and a chooser that has planned the same first step brought there.
  Json kept();
  void go_on(const Json& kept);

  double present_step() const { return h_; }
  double present_relinearize() const { return relinearize_; }
  long rollbacks() const { return rollbacks_; }
  long halved_steps() const { return halved_steps_; }

 private:
  StiffestMode k0_at(const State<Vector>& state, double tolerance);
  std::optional<double> recommended(const StiffestMode& k0, const State<Vector>& state);
  MethodLimits limits(const StiffestMode& k0, const State<Vector>& state);
  StepPlan plan(double largest_step, double duration);
  double growth();
  std::optional<StepPlan> after_divergence(double time, const State<Vector>& state);

  Subject& subject_;
  const CommonOptions& common_;
  const SimulateOptions& options_;
  Method method_;
  bool designed_;
  std::string reason_;
  double h_ = 0, least_step_ = 0;  // [s]
  double k0_ = 0;                  // that of the first plan [1/s²]; 0 where it was not needed
  double relinearize_;             // h_m [s]
  long rollbacks_ = 0, halved_steps_ = 0;
  long failures_in_a_row_ = 0, steps_at_last_failure_ = -1;
};

}  // namespace springstab
