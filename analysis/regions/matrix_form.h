// What the eigenvalues of a method's step on matrices have to do with those on scalar modes, when D' and K'
// do not commute. For an eigenvector v of such a step, |v| = 1,
//     a stability function, A = R(C) of the generator C: λ = R(hμ), where μ² + (v*D'v) μ + v*K'v = 0;
//     scalar coefficients, Q(λ) = a(λ) + b(λ) hD' + c(λ) h²K': v*Q(λ)v = 0;
// so λ is one of the scalar mode (v*D'v, v*K'v), and where all such modes are stable the structure is. Other
// methods (Runge-Kutta-Nyström, velocity Verlet with damping, partitioned ones) promise nothing of the kind.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/method.h"
#include "analysis/regions/characteristic.h"

namespace springstab {

enum class MatrixForm { none, stability_function, scalar_coefficients };

/// Of λ^i, i = 0 ... degree: c, a, b where its coefficient is c + a X + b Y, all over one denominator of that
/// form; nothing where they are not.
std::optional<std::vector<std::array<double, 3>>> affine_coefficients(
    const CharacteristicPolynomial& polynomial);

/// Found out from the method's own step on small matrices that do not commute: an identity of rational
/// functions that holds at a point in general position, to rounding.
MatrixForm matrix_form(const Method& method, const CharacteristicPolynomial& polynomial);

}  // namespace springstab
