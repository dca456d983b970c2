// Motions that neither K nor D resists: rigid ones, and the mechanisms of flat cloth.
#pragma once

#include <optional>
#include <vector>

#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// The structure with as many unknowns held as it has motions v with K v = D v = 0, chosen so that none of
/// them is left. A matrix A that vanishes on those motions is positive semidefinite iff it is so on the
/// unknowns that are left: any x differs by such a motion from one that is zero at the held unknowns.
/// A motion counts where xᵀ(K + D)x, each of unit size, is of rounding's size: 1e-12 of what each unknown has
/// alone, or 1e-14 of the stiffest. K and D must be positive semidefinite.
StructuralMatrices without_rigid_motions(const StructuralMatrices& s);

/// The same where no more is held than unknowns that nothing resists by themselves, as sideways in a flat
/// net, and nobody has looked for other motions, which costs a factorization. Nothing where translations are
/// seen to be among those, or there are so few unknowns that looking costs little.
std::optional<StructuralMatrices> without_free_unknowns(const StructuralMatrices& s);

/// Of each unknown, whether more than rounding resists it by itself.
std::vector<bool> resisted_unknowns(const StructuralMatrices& s);

}  // namespace springstab
