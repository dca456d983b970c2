#include "analysis/definiteness.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>

namespace springstab {
namespace {

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

SparseMatrix scaled(const SparseMatrix& a, const Eigen::VectorXd& d) {
  SparseMatrix b = d.asDiagonal() * a;
  return b * d.asDiagonal();
}

Eigen::VectorXd row_sums(const SparseMatrix& a) { return a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols()); }

double largest_row_sum(const SparseMatrix& a) { return a.size() > 0 ? row_sums(a).maxCoeff() : 0; }

}  // namespace

struct DefinitenessProof::Factor {
  Eigen::SimplicialLLT<SparseMatrix> cholesky;
  bool analyzed = false;
  double last_error = 0;

  // A bound on how far the factorization's rounding may have moved the eigenvalues: Σ γ(l_i + 2) a_ii, where
  // l_i counts row i of the factor (Rump 2006, Verification of positive definiteness, BIT 46).
  double error(double largest_diagonal) const {
    const SparseMatrix& l = cholesky.matrixL().nestedExpression();
    return 1.01 * unit_roundoff * static_cast<double>(l.nonZeros() + 2 * l.rows()) * largest_diagonal;
  }
};

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s) : factor_(std::make_unique<Factor>()) {
  const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
  mass_ = scaled(s.mass, d);
  stiffness_ = scaled(s.stiffness, d);
  if (s.has_damping()) damping_ = scaled(s.damping, d);
  mass_size_ = largest_row_sum(mass_);
  stiffness_size_ = largest_row_sum(stiffness_);
  damping_size_ = largest_row_sum(damping_);
}

DefinitenessProof::~DefinitenessProof() = default;
DefinitenessProof::DefinitenessProof(DefinitenessProof&&) noexcept = default;

bool DefinitenessProof::holds(double c, double a, double b) {
  SparseMatrix matrix = c * mass_ - b * stiffness_;
  if (damping_.size() > 0) matrix = SparseMatrix(matrix - a * damping_);
  const double forming_error =
      8 * unit_roundoff *
      (std::abs(c) * mass_size_ + std::abs(a) * damping_size_ + std::abs(b) * stiffness_size_);
  const Eigen::VectorXd diagonal = matrix.diagonal();
  const double largest_diagonal = diagonal.maxCoeff();
  if (!std::isfinite(forming_error) || !(diagonal.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = unit_roundoff * static_cast<double>(matrix.rows()) * 2 * largest_diagonal;
  if ((2 * diagonal - row_sums(matrix)).minCoeff() > 2 * forming_error + summing_error) return true;
  if (matrix.rows() > factorization_limit) return false;

  SparseMatrix identity(matrix.rows(), matrix.cols());
  identity.setIdentity();
  if (!factor_->analyzed) factor_->cholesky.analyzePattern(matrix);
  factor_->analyzed = true;
  double shift = forming_error + factor_->last_error * largest_diagonal;
  for (int attempt = 0; attempt < 3; ++attempt) {  // the shift depends on the factor, a little
    factor_->cholesky.factorize(matrix - shift * identity);
    if (factor_->cholesky.info() != Eigen::Success) return false;
    const double needed = forming_error + factor_->error(largest_diagonal);
    factor_->last_error = 1.1 * factor_->error(1);
    if (shift >= needed) return true;
    shift = 1.1 * needed;
  }
  return false;
}

}  // namespace springstab
