// Motions that neither K nor D resists: rigid ones, and the mechanisms of flat cloth.
#pragma once

#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// The structure with as many unknowns held as it has motions v with K v = D v = 0, chosen so that none of
/// them is left. A matrix A that vanishes on those motions is positive semidefinite iff it is so on the
/// unknowns that are left: any x differs by such a motion from one that is zero at the held unknowns.
/// A motion counts where a pivot of the factorization of K + D, each scaled to a unit diagonal, is below
/// 1e-9: stiffness and damping of rounding's size. K and D must be positive semidefinite.
StructuralMatrices without_rigid_motions(const StructuralMatrices& s);

}  // namespace springstab
