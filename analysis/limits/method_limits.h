// What `limits` says of one method and one structure: the largest stable step, a proved one, the damping that
// could be fitted, and the step to use.
#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include "analysis/limits/step_limits.h"
#include "analysis/limits/structure.h"
#include "analysis/spectra/spectrum.h"

namespace springstab {

enum class LimitStatus {
  limited,
  unlimited,  // every step is stable
  none,       // no positive step is stable
  unknown     // it was not computed for this kind of damping
};

/// What h_max comes from: exact (for the given k0), or eigenvalues that may not be all that matter.
enum class LimitSource { exact, estimate };

/// What proves h_certified.
enum class Proof {
  none,
  k0_bound,          // every mode's limit up to the proved bound on k0
  quadrant,          // every d, k >= 0 is stable
  matrix_condition,  // the method's own condition on hD' + h²K', factorized
  polygon,           // W lies in a convex polygon of the region, a factorization an edge
  lyapunov           // a norm that falls at every step; of this step alone
};

/// Steps in seconds. Absent where there is none or it is not known; ∞ where nothing limits.
struct MethodLimits {
  LimitStatus status = LimitStatus::unknown;
  std::optional<double> h_max;  // supremum of the stable steps with the structure's own damping
  LimitSource source = LimitSource::exact;
  std::optional<double> h_certified;  // proved stable, at most h_max
  Proof proof = Proof::none;          // of h_certified
  std::string_view unproved{};        // why there is none, in lasting words
  std::optional<double> recommended;  // with the safety factor; at most h_certified; absent where unlimited
  std::optional<DampingDesign> designed;
  // of StructureLimits alone (structure_limits.h):
  std::optional<double> every_pose;        // proved stable below it in whatever pose
  std::optional<double> transient_growth;  // a lower bound of the largest ‖Aⁿ‖ at the recommended step
};

/// Takes the step to use down to h_max/√F, the limit when time runs √F times faster, and to what is proved.
void keep_margin(double safety, MethodLimits& limits);

/// Without damping or with Rayleigh damping these are exact for the given k0. With general damping a method
/// that is stable on the whole quadrant X, Y > 0 is unlimited (every eigenpair has a d >= 0 and a k >= 0);
/// the others are unknown here (see general_damping.h), as is everything when k0 did not converge. `safety`
/// >= 1 acts on the stiffness.
MethodLimits method_limits(const Method& method, const StiffestMode& k0, const DampingModel& damping,
                           double safety);

}  // namespace springstab
