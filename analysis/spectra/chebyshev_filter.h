// The largest eigenvalue of a symmetric operator whose spectrum is bounded below, by ARPACK on a Chebyshev
// polynomial of it. Cloth's stiffest modes lie close together; a restarted iteration then spends most of its
// time on orthogonalizing a short basis, again and again. A polynomial that is small below and steep above
// makes each vector of that basis worth as many products as its degree.
#pragma once

#include "analysis/spectra/arpack.h"

namespace springstab {

/// As largest_eigenpairs(a, 1, options), which it is where a.lowest is -∞ or far below. The tolerance holds
/// for A itself, `residuals` are A's, and `products` counts all with A.
SymmetricEigenpairs largest_eigenpair(const LinearOperator& a, const ArpackOptions& options = {});

}  // namespace springstab
