// States of a run at evenly spaced times.
#pragma once

#include <vector>

#include "analysis/limits/step_policy.h"
#include "experiments/command/options.h"
#include "experiments/inputs/subject.h"

namespace springstab {

/// A state of a run.
struct Moment {
  double time;  // [s]
  State<Vector> state;
};

/// How far a run came, and its moments: count + 1 of one that came to its end.
struct MomentsOfRun {
  std::vector<Moment> moments;
  double time;  // [s]
  StepStatus status;
  bool done;
};

/// Runs the plan of `chooser`, of the same subject, with contact where there is some; moments are evenly
/// spaced from the start to `duration` [s], their number is count + 1.
MomentsOfRun moments_of(Subject& subject, StepChooser& chooser, const StepPlan& plan, double duration,
                        int count, const CommonOptions& common);

}  // namespace springstab
