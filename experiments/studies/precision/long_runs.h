// What errors at the end of a short run do not show: how energy drifts over a long run without damping, and
// how far a slow motion lags while damping takes the fast ones.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/options.h"

namespace springstab {

struct EnergyCurve {
  std::string name;
  std::vector<double> time, drift;  // [s]; |E - E0| of the kinetic energy at the start, so far the largest
  bool diverged = false;            // after the last of them
};

struct EnergyDrift {
  double h = 0, k0 = 0;  // [s], [1/s²]
  std::vector<EnergyCurve> curves;
};

/// An undamped net at h = 1/√k0, half of symplectic Euler's limit, for `steps` steps of every method.
EnergyDrift energy_drift(long steps, const CommonOptions& common);

struct PhaseCurve {
  std::string name;
  std::vector<double> relative_step, degrees;  // h √k0, and the error of the phase in a period
};

/// The slowest mode of a chain of 50 masses with the others beside it, alpha such that the fastest mode is
/// damped critically: four periods of the slow one, at steps from each method's limit down.
std::vector<PhaseCurve> phase_errors(const CommonOptions& common);

}  // namespace springstab
