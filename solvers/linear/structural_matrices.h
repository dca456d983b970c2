// K, M and D of a structure as matrices, checked and made ready: finite, of one size, no unknown massless.
//
//     const SparseMatrix stiffness = read_matrix("K.mtx"), mass = read_matrix("M.mtx");
//     const StructuralMatrices s = prepare(stiffness, mass);
//     std::cout << s.size() << " unknowns, " << s.condensed << " without mass were condensed\n";
#pragma once

#include <Eigen/SparseCore>

#include <span>
#include "solvers/linear/rayleigh_damping.h"
#include "solvers/system.h"

namespace springstab {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// M x'' = -K x - D v. D is all of the damping there is; an empty one (0 x 0) means none.
struct StructuralMatrices {
  SparseMatrix stiffness, mass, damping;
  Eigen::Index condensed = 0;       // massless unknowns that were eliminated
  double condensed_rate = 0;        // at which their own motion decayed [1/s]; 0 where nothing damped them
  bool symmetric = true;            // K and D are; M always is
  SparseMatrix implicit_damping{};  // the part of D that is offered to be taken implicitly; 0 x 0: all of it

  Eigen::Index size() const { return stiffness.rows(); }
  bool has_damping() const { return damping.nonZeros() > 0; }
  bool says_implicit() const { return implicit_damping.size() > 0; }
};

/// D_i, n x n, which a method takes implicitly that asks for this part (solvers/system.h).
SparseMatrix implicit_damping(const StructuralMatrices& s, DampingPart part);

/// Checks the matrices (square, of one size, finite, a_ij and a_ji apart by at most 1e-10 of the larger or of
/// √(a_ii a_jj); their mean replaces both) and eliminates unknowns whose row of M is zero: they follow,
/// K ← K_aa - K_ab K_bb⁻¹ K_ba and likewise D, which needs K_bb positive definite and D = alpha K in their
/// rows, with one alpha >= 0: what they are away from there decays at the rate 1/alpha, whatever the others
/// do. An empty M stands for the unit matrix. D is the sum of what is given; where some of it is given as
/// `implicit_damping`, every unknown needs mass. Throws std::invalid_argument that names the matrix and the
/// rule.
StructuralMatrices prepare(const SparseMatrix& stiffness, const SparseMatrix& mass = {},
                           const SparseMatrix& damping = {}, const RayleighDamping& more = {},
                           const SparseMatrix& implicit_damping = {});

/// The same for any K and D, as of follower forces and rotors; where one is not symmetric it stays so, and
/// every unknown needs mass.
StructuralMatrices prepare_nonsymmetric(const SparseMatrix& stiffness, const SparseMatrix& mass = {},
                                        const SparseMatrix& damping = {}, const RayleighDamping& more = {},
                                        const SparseMatrix& implicit_damping = {});

/// M of particles with three unknowns each: diagonal; one mass per particle [kg].
SparseMatrix lumped_mass(std::span<const double> mass);

/// diag(d) A diag(d), in place.
void scale(SparseMatrix& a, const Eigen::VectorXd& d);
SparseMatrix scaled(const SparseMatrix& a, const Eigen::VectorXd& d);

/// Of a compressed matrix.
int most_in_a_column(const SparseMatrix& a);

/// Whether nothing is stored off the diagonal.
bool is_diagonal(const SparseMatrix& a);

}  // namespace springstab
