#include "analysis/proofs/definiteness.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/pieces.h"
#endif

namespace springstab {
namespace {

Eigen::VectorXd row_sums(const SparseMatrix& a) { return a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols()); }

// A, plus 1e-9 of its diagonal and 1e-13 of its largest entry.
SparseMatrix lifted(SparseMatrix a) {
  const double largest = a.coeffs().abs().maxCoeff();
  a.diagonal() +=
      (1e-9 * a.diagonal().cwiseAbs() + Eigen::VectorXd::Constant(a.rows(), 1e-13 * largest)).eval();
  return a;
}

}  // namespace

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s, double loss) : loss_(loss) {
  const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
  mass_ = scaled(s.mass, d);
  stiffness_ = scaled(s.stiffness, d);
  if (s.has_damping()) damping_ = scaled(s.damping, d);
  mass_size_ = row_sums(mass_);
  stiffness_size_ = row_sums(stiffness_);
  damping_size_ = s.has_damping() ? row_sums(damping_) : Eigen::VectorXd::Zero(s.size());
}

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s, std::shared_ptr<const Pieces> own,
                                     std::function<bool(bool)> all_of)
    : DefinitenessProof(s) {
  pieces_ = std::move(own);
  all_of_ = std::move(all_of);
}

// c M - a D - b K, with an entry for each of theirs.
SparseMatrix DefinitenessProof::sum(double c, double a, double b) const {
  SparseMatrix matrix = c * mass_ - b * stiffness_;
  if (damping_.size() > 0) matrix = SparseMatrix(matrix - a * damping_);
  return matrix;
}

// What is too large to be factorized at once.
bool DefinitenessProof::in_pieces([[maybe_unused]] const SparseMatrix& matrix) {
#ifdef SPRINGSTAB_CHOLMOD
  if (!pieces_)
    pieces_ = std::make_shared<const Pieces>(matrix, Pieces::usual_particles, Pieces::layers_for(loss_));
  return all_of(pieces_->prove(matrix));
#else
  return false;
#endif
}

int DefinitenessProof::pieces() const {
#ifdef SPRINGSTAB_CHOLMOD
  return pieces_ ? pieces_->count() : 0;
#else
  return 0;
#endif
}

bool DefinitenessProof::factorizes() { return cholesky_.analyze(sum(1, 1, 1)); }

bool DefinitenessProof::holds(double c, double a, double b) {
  SparseMatrix matrix = sum(c, a, b);
  const Eigen::VectorXd forming_error =
      8 * unit_roundoff *
      (std::abs(c) * mass_size_ + std::abs(a) * damping_size_ + std::abs(b) * stiffness_size_);
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (!all_of(forming_error.allFinite() && diagonal.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = 2 * unit_roundoff * static_cast<double>(matrix.rows());
  if (all_of((2 * diagonal - row_sums(matrix) - 2 * forming_error - summing_error * diagonal).minCoeff() > 0))
    return true;
  if (all_of_ || !cholesky_.analyze(matrix)) {
    matrix.diagonal() -= forming_error;
    return in_pieces(matrix);
  }
  matrix.diagonal() -= forming_error + cholesky_.error() * diagonal;
  return cholesky_.factorize(matrix);
}

bool DefinitenessProof::stiffness_is_semidefinite() {
  if (!stiffness_is_semidefinite_)
    stiffness_is_semidefinite_ = stiffness_.nonZeros() == 0 || cholesky_.factorize(lifted(sum(0, 0, -1)));
  return *stiffness_is_semidefinite_;
}

bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass) {
  return DefinitenessProof({a, mass, {}}).stiffness_is_semidefinite();
}

}  // namespace springstab
