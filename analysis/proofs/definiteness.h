// Proofs by Cholesky factorization that a matrix is positive definite in spite of rounding.
#pragma once

#include "analysis/proofs/sparse_cholesky.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Proofs for one structure, with one symbolic factorization for all its proofs.
class DefinitenessProof {
 public:
  /// Copies what it needs, scaled so that the mass has a unit diagonal. Where SparseCholesky finds too many
  /// unknowns nothing is factorized, and only diagonally dominant matrices are proved.
  explicit DefinitenessProof(const StructuralMatrices& s);

  /// Whether c M - a D - b K is proved to be positive definite. No proof is no proof of the contrary.
  bool holds(double c, double a, double b);

  /// Whether matrices of this pattern are factorized at all. Analyzes it.
  bool factorizes();

  /// Whether K has no eigenvalue below zero but for rounding: see is_semidefinite.
  bool stiffness_is_semidefinite();

 private:
  SparseMatrix sum(double c, double a, double b) const;

  SparseMatrix mass_, damping_, stiffness_;
  Eigen::VectorXd mass_size_, damping_size_, stiffness_size_;  // absolute row sums
  SparseCholesky cholesky_;
};

/// Whether a symmetric matrix has no eigenvalue below zero but for rounding: of 1e-9 of the diagonal, unknown
/// by unknown, and of 1e-13 of the largest entry of M^-½ A M^-½. By a Cholesky factorization.
bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass);

}  // namespace springstab
