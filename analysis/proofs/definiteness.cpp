#include "analysis/proofs/definiteness.h"

#include <Eigen/SparseCholesky>
#include <cmath>

#include "analysis/constants.h"

namespace springstab {
namespace {

Eigen::VectorXd row_sums(const SparseMatrix& a) { return a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols()); }

}  // namespace

struct DefinitenessProof::Factor {
  Eigen::SimplicialLLT<SparseMatrix> cholesky;
  bool analyzed = false;
  double last_error = 0;

  // A bound e: the factorization is that of A + ΔA with -e diag(A) <= ΔA <= e diag(A), for it is so in the
  // scale where A has a unit diagonal: Σ γ(l_i + 2), where l_i counts row i of the factor (Rump 2006,
  // Verification of positive definiteness, BIT 46).
  double error() const {
    const SparseMatrix& l = cholesky.matrixL().nestedExpression();
    return 1.01 * unit_roundoff * static_cast<double>(l.nonZeros() + 2 * l.rows());
  }
};

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s) : factor_(std::make_unique<Factor>()) {
  const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
  mass_ = scaled(s.mass, d);
  stiffness_ = scaled(s.stiffness, d);
  if (s.has_damping()) damping_ = scaled(s.damping, d);
  mass_size_ = row_sums(mass_);
  stiffness_size_ = row_sums(stiffness_);
  damping_size_ = s.has_damping() ? row_sums(damping_) : Eigen::VectorXd::Zero(s.size());
}

DefinitenessProof::~DefinitenessProof() = default;
DefinitenessProof::DefinitenessProof(DefinitenessProof&&) noexcept = default;

bool DefinitenessProof::holds(double c, double a, double b) {
  SparseMatrix matrix = c * mass_ - b * stiffness_;
  if (damping_.size() > 0) matrix = SparseMatrix(matrix - a * damping_);
  const Eigen::VectorXd forming_error =
      8 * unit_roundoff *
      (std::abs(c) * mass_size_ + std::abs(a) * damping_size_ + std::abs(b) * stiffness_size_);
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (!forming_error.allFinite() || !(diagonal.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = 2 * unit_roundoff * static_cast<double>(matrix.rows());
  if ((2 * diagonal - row_sums(matrix) - 2 * forming_error - summing_error * diagonal).minCoeff() > 0)
    return true;
  if (matrix.rows() > factorization_limit) return false;

  if (!factor_->analyzed) factor_->cholesky.analyzePattern(matrix);
  factor_->analyzed = true;
  double error = factor_->last_error;
  for (int attempt = 0; attempt < 3; ++attempt) {  // the shift depends on the factor, a little
    SparseMatrix shifted = matrix;
    shifted.diagonal() -= forming_error + error * diagonal;
    factor_->cholesky.factorize(shifted);
    if (factor_->cholesky.info() != Eigen::Success) return false;
    const double needed = factor_->error();
    factor_->last_error = 1.1 * needed;
    if (error >= needed) return true;
    error = 1.1 * needed;
  }
  return false;
}

bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass) {
  const Eigen::VectorXd d = mass.diagonal().cwiseSqrt().cwiseInverse();
  SparseMatrix shifted = scaled(a, d);
  if (shifted.nonZeros() == 0) return true;
  const double largest = shifted.coeffs().abs().maxCoeff();
  const Eigen::VectorXd diagonal = shifted.diagonal();
  SparseMatrix shift(a.rows(), a.cols());
  shift.setIdentity();
  shift.diagonal() = 1e-9 * diagonal.cwiseAbs() + Eigen::VectorXd::Constant(a.rows(), 1e-13 * largest);
  return Eigen::SimplicialLLT<SparseMatrix>(shifted + shift).info() == Eigen::Success;
}

}  // namespace springstab
