// The step up to which a method keeps a damped system stable, from the eigenvalues of the method's own state
// transition matrix A(h): for methods that have no stability function, on any K and D.
//     no eigenvalue of A(h) is outside the unit circle but those of motions that grow by themselves
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/method.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// The largest H such that at every 0 < h < H no more eigenvalues of A(h) are outside the unit circle than
/// `modes`, all eigenvalues of the generator, have with Re μ > 0: an estimate, since h is sampled, a third
/// further each time, before the first step that fails is narrowed down to 1e-10. 0 where no positive step
/// holds; ∞ where none up to 1000 over the largest |μ| fails. Nothing for methods that solve a system, and
/// where smaller steps than rounding allows would have to tell.
std::optional<double> transition_limit(const Method& method, const StructuralMatrices& s,
                                       const std::vector<std::complex<double>>& modes);

}  // namespace springstab
