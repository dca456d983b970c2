// The largest eigenvalue of a symmetric operator to few digits, by Lanczos' three-term recurrence without a
// basis: three vectors in all, and a product a step. Rounding makes copies of eigenvalues that have
// converged, which does no harm to the largest. Many eigenvalues of cloth lie just below it, so that a vector
// mixed of those is found long before they are told apart: residual r leaves an error of the value that is
// far smaller, below r/2 in all measured cases.
#pragma once

#include "analysis/spectra/arpack.h"

namespace springstab {

/// Whoever wants k0 of many unknowns more accurately has ARPACK.
inline constexpr double lanczos_tolerance = 1e-6;

/// The largest eigenvalue, to options.tolerance of ‖Av - θv‖ relative to |θ|, as the recurrence has it. The
/// vector, of unit norm, takes as many products again. Not converged, and empty, after 40 / √tolerance steps.
/// Throws std::invalid_argument for a product that is not finite.
SymmetricEigenpairs largest_by_lanczos(const LinearOperator& a, const ArpackOptions& options,
                                       bool with_vector);

}  // namespace springstab
