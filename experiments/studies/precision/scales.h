// The times at which trajectories are compared, and the sizes that make an adaptive integrator's tolerance
// absolute: the same for the reference and for every library.
#pragma once

#include <vector>

#include "experiments/studies/precision/problem.h"

namespace springstab {

struct Scales {
  double place;     // the largest coordinate at the start [m]
  double velocity;  // the largest one there, but at least `place` per duration [m/s]
};

Scales scales_of(const Problem& problem);

/// i duration / trajectory_samples, i from 1 [s].
std::vector<double> sample_times(const Problem& problem);

}  // namespace springstab
