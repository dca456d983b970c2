// Matrices that are positive semidefinite by what they are made of, as springs at rest or stretched and
// dampers along springs are: with 3×3 blocks B_ij = -A_ij,
//     A = Σ over i < j of [[B_ij, -B_ij], [-B_ij, B_ij]] + diag(A_ii - Σ_j B_ij),
// a sum of positive semidefinite matrices where all B_ij and all blocks of the diagonal's rest are so.
#pragma once

#include <optional>

#include "solvers/linear/structural_matrices.h"
#include "solvers/team.h"

namespace springstab {

/// Whether the symmetric A is proved to be positive semidefinite by that, in spite of rounding: of A's
/// diagonal 1e-11 must be left. One pass over A, three unknowns a particle, which ends at a B_ij that is not
/// semidefinite.
bool is_sum_of_couplings(const SparseMatrix& a);

/// The largest ρ >= 0, to 1e-8, with which D - ρ K, both symmetric, is proved to be so, but for 2e-11 of D's
/// diagonal and for unknowns that only rounding resists, which are held: no coupling has a damper weaker than
/// ρ times its stiffness. Of some columns, those of a particle together; of all of them the least ρ holds.
/// Infinite where K is 0; nothing where D is no such sum.
std::optional<double> coupling_ratio(const StructuralMatrices& s, IndexRange columns);

}  // namespace springstab
