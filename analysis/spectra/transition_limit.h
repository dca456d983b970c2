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

inline constexpr Eigen::Index transition_limit_rows = 400;

/// The largest H such that at every 0 < h < H no more eigenvalues of A(h) are outside the unit circle than
/// `modes`, all eigenvalues of the generator, have with Re μ > 0: an estimate, since h is sampled, a third
/// further each time, before the first step that fails is narrowed down to 1e-10. 0 where no positive step
/// holds; ∞ where none up to 1000 over the largest |μ| fails. A step that cannot be solved for does not hold.
/// Nothing above `generator_limit` unknowns or, of a method that carries more than x and v, where A(h) has
/// more rows than `transition_limit_rows`; of a method that solves a system where one is not symmetric; and
/// where smaller steps than rounding allows would have to tell.
std::optional<double> transition_limit(const Method& method, const StructuralMatrices& s,
                                       const std::vector<std::complex<double>>& modes);

/// The limit that the undamped ones of these modes, all eigenvalues of the generator, are for the method: of
/// positive semidefinite K and D they are scalar modes (0, k), for D'v = 0, whatever the method.
double undamped_limit(const Method& method, const std::vector<std::complex<double>>& modes);

}  // namespace springstab
