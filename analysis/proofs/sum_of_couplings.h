// Matrices that are positive semidefinite by what they are made of, as springs at rest or stretched and
// dampers along springs are: with 3×3 blocks B_ij = -A_ij,
//     A = Σ over i < j of [[B_ij, -B_ij], [-B_ij, B_ij]] + diag(A_ii - Σ_j B_ij),
// a sum of positive semidefinite matrices where all B_ij and all blocks of the diagonal's rest are so.
#pragma once

#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Whether the symmetric A is proved to be positive semidefinite by that, in spite of rounding: of A's
/// diagonal 1e-9 must be left. One pass over A, three unknowns a particle, which ends at a B_ij that is not
/// semidefinite.
bool is_sum_of_couplings(const SparseMatrix& a);

}  // namespace springstab
