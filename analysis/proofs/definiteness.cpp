#include "analysis/proofs/definiteness.h"

#include <cmath>

#include "analysis/constants.h"

namespace springstab {
namespace {

Eigen::VectorXd row_sums(const SparseMatrix& a) { return a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols()); }

// A bound e: the factorization is that of A + ΔA with -e diag(A) <= ΔA <= e diag(A).
//
// Row i of L has l_i entries, the last on the diagonal. Each l_ij (or l_ii²) comes from a_ij - Σ_k l_ik l_jk,
// at most l_i - 1 products. In whatever order they are summed, by single numbers or by blocks, into parts of
// their own or at once, with fused operations or without, a product is rounded once and passes through no
// more than l_i - 1 sums; what is divided by l_jj is rounded once, or twice where a BLAS multiplies by the
// reciprocal, as OpenBLAS does. (Products with the zeros that pad a block are exact zeros and round nothing.)
// So, with u the unit roundoff and γ_k = k u/(1 - k u),
//     |ΔA_ij| <= γ(min(l_i, l_j) + 2) Σ_k |l_ik| |l_jk| <= √φ_i √a_ii √φ_j √a_jj,  φ_i = γ(l_i+2)/(1 -
//     γ(l_i+2)),
// by Cauchy and Schwarz, as Σ_k l_ik² <= a_ii/(1 - γ): in the scale where A has a unit diagonal, ΔA is at
// most Σ φ_i, the norm of a matrix of rank one. (Rump 2006, Verification of positive definiteness, BIT 46;
// Higham 2002, Accuracy and Stability, §3.1 and §10.1. It holds for any BLAS that multiplies and adds as the
// definition says, not for Strassen's products or triangular inverses by blocks.)
double factorization_error(const SparseCholesky& cholesky, Eigen::Index size) {
  return 1.01 * unit_roundoff * (cholesky.entries() + 2 * static_cast<double>(size));
}

// A, plus 1e-9 of its diagonal and 1e-13 of its largest entry.
SparseMatrix lifted(SparseMatrix a) {
  const double largest = a.coeffs().abs().maxCoeff();
  a.diagonal() +=
      (1e-9 * a.diagonal().cwiseAbs() + Eigen::VectorXd::Constant(a.rows(), 1e-13 * largest)).eval();
  return a;
}

}  // namespace

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s) {
  const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
  mass_ = scaled(s.mass, d);
  stiffness_ = scaled(s.stiffness, d);
  if (s.has_damping()) damping_ = scaled(s.damping, d);
  mass_size_ = row_sums(mass_);
  stiffness_size_ = row_sums(stiffness_);
  damping_size_ = s.has_damping() ? row_sums(damping_) : Eigen::VectorXd::Zero(s.size());
}

// c M - a D - b K, with an entry for each of theirs.
SparseMatrix DefinitenessProof::sum(double c, double a, double b) const {
  SparseMatrix matrix = c * mass_ - b * stiffness_;
  if (damping_.size() > 0) matrix = SparseMatrix(matrix - a * damping_);
  return matrix;
}

bool DefinitenessProof::factorizes() { return cholesky_.analyze(sum(1, 1, 1)); }

bool DefinitenessProof::holds(double c, double a, double b) {
  SparseMatrix matrix = sum(c, a, b);
  const Eigen::VectorXd forming_error =
      8 * unit_roundoff *
      (std::abs(c) * mass_size_ + std::abs(a) * damping_size_ + std::abs(b) * stiffness_size_);
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (!forming_error.allFinite() || !(diagonal.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = 2 * unit_roundoff * static_cast<double>(matrix.rows());
  if ((2 * diagonal - row_sums(matrix) - 2 * forming_error - summing_error * diagonal).minCoeff() > 0)
    return true;
  if (!cholesky_.analyze(matrix)) return false;
  matrix.diagonal() -= forming_error + factorization_error(cholesky_, matrix.rows()) * diagonal;
  return cholesky_.factorize(matrix);
}

bool DefinitenessProof::stiffness_is_semidefinite() {
  return stiffness_.nonZeros() == 0 || cholesky_.factorize(lifted(sum(0, 0, -1)));
}

bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass) {
  return DefinitenessProof({a, mass, {}}).stiffness_is_semidefinite();
}

}  // namespace springstab
