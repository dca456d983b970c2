// Methods that take only a part D_i of the damping D implicitly (solvers/methods/implicit_damping_euler.h):
//     stable exactly while λ_max(y h²K' + x h(D' + r D_i')) < c,   for K, D, D_i positive semidefinite,
// where x, y, c are the condition of the damping that stays explicit and (1 + r) x that of the rest. (With
// p = v*hD_i'v, an eigenvector v has (1 + p)(λ - 1)² + (λ - 1) X + λY = 0 for Euler's method, of which only
// λ = -1 can be on the unit circle: 4 + 4p - 2X - Y = 0.)
#pragma once

#include "analysis/method.h"
#include "analysis/regions/stability_region.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Whether the part that the method takes implicitly need not be all of D.
bool takes_part(const Method& method, const StructuralMatrices& s);

/// The same, and whether it is not all of D. `s` with its damping.
bool splits_damping(const Method& method, const StructuralMatrices& s);

/// x X + y Y <= c of one oscillator of which nothing is damped implicitly: from the method's own steps.
HalfPlane explicit_condition(const Method& method);

/// Of the explicit part where it takes one, else the region's exact condition.
std::optional<HalfPlane> matrix_condition(const Method& method, const StructuralMatrices& s);

/// The structure with D + r D_i in place of D.
StructuralMatrices with_effective_damping(const Method& method, const StructuralMatrices& s);

}  // namespace springstab
