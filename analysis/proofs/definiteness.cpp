#include "analysis/proofs/definiteness.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/constants.h"
#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/pieces.h"
#endif

namespace springstab {
namespace {

Eigen::VectorXd row_sums(const SparseMatrix& a) { return a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols()); }

// The entries of `a`, one for each entry of `all`, whose pattern holds that of `a`.
Eigen::VectorXd entries_in(const SparseMatrix& all, const SparseMatrix& a) {
  Eigen::VectorXd entries(all.nonZeros());
  for (Eigen::Index j = 0, at = 0; j < all.cols(); ++j) {
    SparseMatrix::InnerIterator own(a, j);
    for (SparseMatrix::InnerIterator entry(all, j); entry; ++entry, ++at) {
      const bool there = own && own.row() == entry.row();
      entries[at] = there ? own.value() : 0;
      if (there) ++own;
    }
  }
  return entries;
}

// Whether `all`, which is compressed, has an entry wherever `a` has one.
bool holds_pattern(const SparseMatrix& all, const SparseMatrix& a) {
  if (!all.isCompressed()) return false;
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    SparseMatrix::InnerIterator entry(all, j);
    for (SparseMatrix::InnerIterator own(a, j); own; ++own) {
      while (entry && entry.row() < own.row()) ++entry;
      if (!entry || entry.row() != own.row()) return false;
    }
  }
  return true;
}

}  // namespace

DefinitenessProof::DefinitenessProof(StructuralMatrices s, double loss)
    : lumped_(is_diagonal(s.mass)), loss_(loss) {
  const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
  for (SparseMatrix* a : {&s.mass, &s.stiffness, &s.damping}) scale(*a, d);
  mass_size_ = row_sums(s.mass);
  stiffness_size_ = row_sums(s.stiffness);
  damping_size_ = s.has_damping() ? row_sums(s.damping) : Eigen::VectorXd::Zero(s.size());
  if (holds_pattern(s.stiffness, s.mass) && (!s.has_damping() || holds_pattern(s.stiffness, s.damping))) {
    stiffness_ = s.stiffness.coeffs();
    matrix_ = std::move(s.stiffness);
  } else {
    matrix_ = s.mass + s.stiffness;
    if (s.has_damping()) matrix_ = SparseMatrix(matrix_ + s.damping);
    stiffness_ = entries_in(matrix_, s.stiffness);
  }
  if (s.has_damping()) damping_ = entries_in(matrix_, s.damping);
  mass_ = lumped_ ? Eigen::VectorXd(s.mass.diagonal()) : entries_in(matrix_, s.mass);
  diagonal_.resize(matrix_.rows());
  sizes_.resize(matrix_.rows());
}

DefinitenessProof::DefinitenessProof(StructuralMatrices s, std::shared_ptr<const Pieces> own,
                                     std::function<bool(bool)> all_of)
    : DefinitenessProof(std::move(s)) {
  pieces_ = std::move(own);
  all_of_ = std::move(all_of);
}

// c M - a D - b K, in one pass.
void DefinitenessProof::form(double c, double a, double b) {
  double* const value = matrix_.valuePtr();
  const bool damped = damping_.size() > 0;
  for (Eigen::Index j = 0; j < matrix_.cols(); ++j) {
    double size = 0;
    diagonal_[j] = 0;
    for (Eigen::Index p = matrix_.outerIndexPtr()[j]; p < matrix_.outerIndexPtr()[j + 1]; ++p) {
      const bool on_diagonal = matrix_.innerIndexPtr()[p] == j;
      const double mass = !lumped_ ? mass_[p] : on_diagonal ? mass_[j] : 0;
      double v = c * mass - b * stiffness_[p];
      if (damped) v -= a * damping_[p];
      value[p] = v;
      size += std::abs(v);
      if (on_diagonal) diagonal_[j] = v;
    }
    sizes_[j] = size;
  }
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

bool DefinitenessProof::factorizes() { return cholesky_.analyze(matrix_); }

bool DefinitenessProof::holds(double c, double a, double b) {
  form(c, a, b);
  const Eigen::VectorXd forming_error =
      8 * unit_roundoff *
      (std::abs(c) * mass_size_ + std::abs(a) * damping_size_ + std::abs(b) * stiffness_size_);
  if (!all_of(forming_error.allFinite() && diagonal_.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = 2 * unit_roundoff * static_cast<double>(matrix_.rows());
  if (all_of((2 * diagonal_ - sizes_ - 2 * forming_error - summing_error * diagonal_).minCoeff() > 0))
    return true;
  if (all_of_ || !cholesky_.analyze(matrix_)) {
    matrix_.diagonal() -= forming_error;
    return in_pieces(matrix_);
  }
  matrix_.diagonal() -= forming_error + cholesky_.error() * diagonal_;
  return cholesky_.factorize(matrix_);
}

// Of K plus 1e-9 of its diagonal and 1e-13 of its largest entry.
bool DefinitenessProof::stiffness_is_semidefinite() {
  if (!stiffness_is_semidefinite_) {
    form(0, 0, -1);
    const double largest = matrix_.nonZeros() > 0 ? matrix_.coeffs().abs().maxCoeff() : 0;
    const Eigen::VectorXd lift = (1e-9 * diagonal_.array().abs() + 1e-13 * largest).matrix();
    matrix_.diagonal() += lift;
    stiffness_is_semidefinite_ = largest == 0 || cholesky_.factorize(matrix_);
  }
  return *stiffness_is_semidefinite_;
}

bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass) {
  return DefinitenessProof({a, mass, {}}).stiffness_is_semidefinite();
}

}  // namespace springstab
