// What happens to the state after a step, whatever method took it, as contact does.
#pragma once

#include "solvers/state.h"
#include "solvers/system.h"

namespace springstab {

/// What a filter has done: where it failed, the step is to be taken back; where the step has outgrown what it
/// was planned for, the run is, to its last checkpoint, for another plan.
enum class Filtered { unchanged, changed, failed, outgrown };

/// Changes states between steps of a run (simulation.h).
class StepFilter {
 public:
  virtual ~StepFilter() = default;
  /// `after` is what a step of h [s] has made of `before`, at the time t [s].
  virtual Filtered apply(double t, double h, const State<Vector>& before, State<Vector>& after) = 0;
};

}  // namespace springstab
