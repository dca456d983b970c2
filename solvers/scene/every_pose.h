// Bounds on a spring net's stiffness and damping that no motion exceeds: in every pose with l > 0
//     K(x) ⪯ Σ k_s L_s ⊗ I₃,   C(x) ⪯ Σ k_d L_s ⊗ I₃,
// with L_s the spring's graph Laplacian, because a spring's Jacobian has the eigenvalues k_s and
// k_s (1 - l0/l) < k_s, and its damper's k_d and 0 (theory: springs only).
#pragma once

#include "solvers/linear/block_linear_system.h"
#include "solvers/linear/structural_matrices.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab {

/// One unknown per free particle, in the order of their numbers: K = Σ k_s L_s, M, and D = d0 M + alpha K +
/// Σ k_d L_s where there is any. `pinned` ascends.
StructuralMatrices every_pose(const SpringNet& net, const std::vector<int>& pinned,
                              const RayleighDamping& damping);

}  // namespace springstab
