// What `springstab simulate` tells its user on stderr beside the result.
#pragma once

#include "experiments/simulate_options.h"

namespace springstab {

/// Which of the options that were typed change nothing, and why.
void print_unused_options(const CommonOptions& common, const SimulateOptions& options, bool matrices);

/// Whether the step is too long to follow the motion from `start`.
void print_step_warning(Subject& subject, const State<Vector>& start, double step);

}  // namespace springstab
