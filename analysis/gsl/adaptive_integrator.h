// Integrators that choose their own steps, from the GNU Scientific Library.
#pragma once

#include <functional>
#include <vector>

#include "solvers/system.h"

namespace springstab {

enum class AdaptiveMethod {
  rk8pd,  // Prince and Dormand's Runge-Kutta pair of orders 8 and 9
  rkf45,  // Fehlberg's of orders 4 and 5, the library's general-purpose one
  bsimp,  // Bader and Deuflhard's extrapolated semi-implicit midpoint rule, for stiff problems
  msbdf,  // backward differentiation of orders 1 to 5, for stiff problems
};

struct AdaptiveOptions {
  AdaptiveMethod method = AdaptiveMethod::rk8pd;
  double tolerance = 1e-12;            // error of a step, of each unknown: relative, and times its scale
  double place_scale = 1;              // [m]
  double velocity_scale = 1;           // [m/s]
  std::function<bool()> give_up = {};  // asked at every force evaluation
};

struct AdaptiveResult {
  bool finished = false;
  long steps = 0;  // accepted
  long force_evaluations = 0;
  std::vector<State<Vector>> at;  // at the times that were asked for, as far as it came
};

/// Integrates x'' = acceleration(x, v) from `start` at time 0 to the ascending `times` [s]. The two for stiff
/// problems hold dense matrices of 2n rows, and take their Jacobians by differences: 2n force evaluations
/// each.
AdaptiveResult integrate_adaptively(System& system, const State<Vector>& start,
                                    const std::vector<double>& times, const AdaptiveOptions& options);

}  // namespace springstab
