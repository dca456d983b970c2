// The largest eigenvalue of a symmetric operator to few digits, by Lanczos' three-term recurrence, without
// orthogonalization: a product and a few passes over vectors a step. Rounding makes copies of eigenvalues
// that have converged, which does no harm to the largest. Many eigenvalues of cloth lie just below it, so
// that a vector mixed of those is found long before they are told apart: residual r leaves an error of the
// value that is far smaller, below r/2 in all measured cases.
#pragma once

#include "analysis/spectra/arpack.h"

namespace springstab {

/// Numbers of a basis that is kept: half a gigabyte.
inline constexpr Eigen::Index usually_kept = 64'000'000;

/// Whoever wants k0 of many unknowns more accurately has ARPACK.
inline constexpr double lanczos_tolerance = 1e-6;

/// The largest eigenvalue, to options.tolerance of ‖Av - θv‖ relative to |θ|, as the recurrence has it. The
/// vector, of unit norm, takes the basis, or where that has more than `most_kept` numbers as many products
/// again. Not converged, and empty, after 40 / √tolerance steps. Throws std::invalid_argument for a product
/// that is not finite.
SymmetricEigenpairs largest_by_lanczos(const LinearOperator& a, const ArpackOptions& options,
                                       bool with_vector, Eigen::Index most_kept = usually_kept);

}  // namespace springstab
