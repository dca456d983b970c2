// The largest stable step of a method for a whole spectrum of modes, and the damping that goes with it.
#pragma once

#include <optional>

#include "analysis/regions/stability_region.h"

namespace springstab {

/// Modes with stiffness k in [k_min, k_max] [1/s²] under Rayleigh damping d = d0 + alpha k (paper Eq. 28).
/// They fill the line X = h d0 + (alpha/h) Y of the X-Y plane (Eq. 29). Of an unstable structure there are
/// also modes with k in [k_lowest, 0), each a motion that grows by itself and one that decays.
struct RayleighModes {
  double k_min = 0;
  double k_max = 0;
  double d0 = 0;        // [1/s]
  double alpha = 0;     // [s]
  double k_lowest = 0;  // <= 0; below 0 modes down to there grow [1/s²]
};

/// The largest H [s] such that at every step 0 < h < H every motion is stable or neutral that does not grow
/// by itself: 0 where no positive step is, ∞ where all are. Throws std::invalid_argument for negative or
/// non-finite modes, and for k_lowest > 0.
double critical_step(const StabilityRegion& region, const RayleighModes& modes);

/// A step and the stiffness-proportional damping fitted to it.
struct DampingDesign {
  double h_max;  // [s]; ∞ where nothing limits it, 0 where there is no positive step
  double alpha;  // [s]
};

/// The largest h over all alpha >= 0 for which the whole mode line 0 <= k <= k_max is stable or neutral
/// (theory: paper §3.2 in general). For d0 = 0 it is the paper's rule, h = √(Y_max/k_max), α = h X_max/Y_max.
DampingDesign design_damping(const StabilityRegion& region, double k_max, double d0);

/// The alpha that belongs to a given step: the line that reaches the largest Y from (h d0, 0).
double designed_alpha(const StabilityRegion& region, double h, double d0);
/// The same of a method; 0 of one that takes a part of the damping implicitly that is not of modes.
double designed_alpha(const Method& method, double h, double d0);

/// The limit with a safety factor F on the stiffness: the smallest of the limits for K, for F·K with D fixed,
/// for F·K with alpha fixed, and of the limit for F·K with √F·D, which is that for K over √F: time runs
/// faster. (More stiffness can raise an overdamped limit, so F·K alone is not safe, and with fixed damping
/// neither is h/√F.)
double recommended_step(const StabilityRegion& region, const RayleighModes& modes, double safety);

/// The least safety factor in [1, most], to 1e-4, whose recommended step is at most h; nothing where there is
/// none.
std::optional<double> safety_for_step(const StabilityRegion& region, const RayleighModes& modes, double h,
                                      double most);

}  // namespace springstab
