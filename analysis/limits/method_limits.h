// What `limits` says of one method and one structure: the largest stable step, a proved one, the damping that
// could be fitted, and the step to use.
#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include "analysis/limits/step_limits.h"
#include "analysis/spectra/spectrum.h"

namespace springstab {

/// The damping of a structure, as far as limits depend on its form.
struct DampingModel {
  enum class Kind {
    none,
    rayleigh,  // d0 M + alpha K
    designed,  // d0 M + alpha K with alpha fitted to each method's step
    general    // anything else
  };
  Kind kind = Kind::none;
  double d0 = 0;             // [1/s]
  double alpha = 0;          // [s]
  bool semidefinite = true;  // D is positive semidefinite
};

/// D of the matrices: none, Rayleigh if D = d0 M + alpha K fits to 1e-12 with d0, alpha >= 0, else general.
DampingModel classify_damping(const StructuralMatrices& s);

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
  std::string_view unproved{};        // why there is none
  std::optional<double>
      recommended;  // with the safety factor, at most h_certified; absent also where unlimited
  std::optional<DampingDesign> designed;
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
