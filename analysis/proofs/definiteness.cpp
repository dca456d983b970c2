#include "analysis/proofs/definiteness.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/constants.h"
#include "analysis/proofs/sum_of_couplings.h"
#include "solvers/team.h"
#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/pieces.h"
#endif

namespace springstab {
namespace {

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
    : own_(std::make_unique<const StructuralMatrices>(std::move(s))),
      stiffness_(&own_->stiffness),
      mass_(&own_->mass),
      damping_(own_->has_damping() ? &own_->damping : nullptr),
      loss_(loss) {
  take_matrices();
}

DefinitenessProof::DefinitenessProof(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                     const SparseMatrix* damping, double loss)
    : stiffness_(&stiffness), mass_(&mass), damping_(damping), loss_(loss) {
  take_matrices();
}

DefinitenessProof::DefinitenessProof(const StructuralMatrices& s, std::shared_ptr<const Pieces> own,
                                     std::function<bool(bool)> all_of)
    : DefinitenessProof(&s) {
  pieces_ = std::move(own);
  all_of_ = std::move(all_of);
}

void DefinitenessProof::take_matrices() {
  root_ = mass_->diagonal().cwiseSqrt().cwiseInverse();
  if (holds_pattern(*stiffness_, *mass_) && (!damping_ || holds_pattern(*stiffness_, *damping_))) return;
  SparseMatrix all = *stiffness_ + 0.0 * *mass_;
  if (damping_) all = SparseMatrix(all + 0.0 * *damping_);
  widened_ = std::make_unique<const SparseMatrix>(std::move(all));
  stiffness_ = widened_.get();
}

// Column j, an entry for each of K's, in the scale in which M has a unit diagonal.
DefinitenessProof::Column DefinitenessProof::form(const Sum& sum, Eigen::Index j, double* values) const {
  SparseMatrix::InnerIterator mass(*mass_, j), damping(damping_ ? *damping_ : *mass_, j);
  const int *const row = stiffness_->innerIndexPtr(), *const start = stiffness_->outerIndexPtr();
  double masses = 0, dampings = 0, stiffnesses = 0;  // absolute sums
  Column column;
  for (int p = start[j]; p < start[j + 1]; ++p) {
    const auto take = [&](SparseMatrix::InnerIterator& of, double& size) {
      if (!of || of.row() != row[p]) return 0.0;
      const double scaled = root_[row[p]] * of.value() * root_[j];
      ++of;
      size += std::abs(scaled);
      return scaled;
    };
    const double stiffness = root_[row[p]] * stiffness_->valuePtr()[p] * root_[j];
    stiffnesses += std::abs(stiffness);
    double v = sum.c * take(mass, masses) - sum.b * stiffness;
    if (damping_) v -= sum.a * take(damping, dampings);
    *values++ = v;
    column.size += std::abs(v);
    if (row[p] == j) column.diagonal = v;
  }
  column.error = 8 * unit_roundoff *
                 (std::abs(sum.c) * masses + std::abs(sum.a) * dampings + std::abs(sum.b) * stiffnesses);
  return column;
}

DefinitenessProof::Columns DefinitenessProof::measure(const Sum& sum) const {
  const Eigen::Index n = stiffness_->cols();
  constexpr double column_cost = 60;  // [ns]
  Columns all{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  share_range(n, column_cost, [&](long first, long last) {
    std::vector<double> values(static_cast<std::size_t>(most_in_a_column(*stiffness_)));
    for (long j = first; j < last; ++j) {
      const Column column = form(sum, j, values.data());
      all.diagonal[j] = column.diagonal, all.size[j] = column.size, all.error[j] = column.error;
    }
  });
  return all;
}

// Plus a diagonal.
void DefinitenessProof::form_whole(const Sum& sum, const Eigen::VectorXd& added) {
  if (matrix_.size() == 0) matrix_ = *stiffness_;
  for (Eigen::Index j = 0; j < matrix_.cols(); ++j)
    form(sum, j, matrix_.valuePtr() + matrix_.outerIndexPtr()[j]);
  matrix_.diagonal() += added;
}

// What is too large to be factorized at once.
bool DefinitenessProof::in_pieces([[maybe_unused]] const Sum& sum, [[maybe_unused]] const Columns& columns) {
#ifdef SPRINGSTAB_CHOLMOD
  if (!pieces_) pieces_ = std::make_shared<const Pieces>(*stiffness_, Pieces::layers_for(loss_));
  const Eigen::VectorXd diagonal = columns.diagonal - columns.error;
  return all_of(
      pieces_->prove({*stiffness_, diagonal, [&](Eigen::Index j, double* values) { form(sum, j, values); }}));
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

bool DefinitenessProof::factorizes() { return cholesky_.analyze(*stiffness_); }

bool DefinitenessProof::holds(double c, double a, double b) {
  const Sum sum{c, a, b};
  const Columns columns = measure(sum);
  const auto& [diagonal, size, error] = columns;
  if (!all_of(error.allFinite() && diagonal.minCoeff() > 0)) return false;

  // Gershgorin: 2 a_ii exceeds the row's absolute sum, whose own rounding is below n unit roundoffs of it.
  const double summing_error = 2 * unit_roundoff * static_cast<double>(diagonal.size());
  if (all_of((2 * diagonal - size - 2 * error - summing_error * diagonal).minCoeff() > 0)) return true;
  if (all_of_ || !factorizes()) return in_pieces(sum, columns);
  form_whole(sum, -(error + cholesky_.error() * diagonal));
  return cholesky_.factorize(matrix_);
}

// Of K plus 1e-9 of its diagonal and 1e-13 of its largest entry.
bool DefinitenessProof::stiffness_is_semidefinite() {
  if (!stiffness_is_semidefinite_) {
    const Eigen::VectorXd diagonal = measure({0, 0, -1}).diagonal;
    form_whole({0, 0, -1}, Eigen::VectorXd::Zero(diagonal.size()));
    const double largest = matrix_.nonZeros() > 0 ? matrix_.coeffs().abs().maxCoeff() : 0;
    matrix_.diagonal() += (1e-9 * diagonal.array().abs() + 1e-13 * largest).matrix();
    stiffness_is_semidefinite_ = largest == 0 || is_sum_of_couplings(matrix_) || cholesky_.factorize(matrix_);
  }
  return *stiffness_is_semidefinite_;
}

bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass) {
  return DefinitenessProof(a, mass).stiffness_is_semidefinite();
}

}  // namespace springstab
