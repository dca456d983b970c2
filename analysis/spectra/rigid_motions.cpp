#include "analysis/spectra/rigid_motions.h"

#include <Eigen/OrderingMethods>
#include <utility>
#include <vector>

#include "analysis/proofs/sparse_cholesky.h"

namespace springstab {
namespace {

// Of xᵀAx, to be taken times a_ii x_i² and, since larger entries may have left it in a_ii, times m_i x_i².
constexpr double rounding = 1e-12, global_rounding = 1e-14;
constexpr double sound =
    1e8;  // times the rounding of x_k alone: not rounding, however far the motion reaches

/// What resists in a structure, and which unknowns are not held.
struct Resisted {
  SparseMatrix sum;             // K + D, each of unit size
  Eigen::VectorXd least_pivot;  // rounding's
  std::vector<int> place;       // among those that move, which keep their order, or -1
  int size = 0;

  explicit Resisted(const StructuralMatrices& s);

  template <class Moves>
  void keep(const Moves& moves) {
    place.assign(sum.rows(), -1);
    size = 0;
    for (Eigen::Index i = 0; i < sum.rows(); ++i)
      if (moves(i)) place[i] = size++;
  }
};

// The largest diagonal entry per unit of mass; 1 where all are 0.
double unit_of(const SparseMatrix& a, const Eigen::VectorXd& mass) {
  const double largest = Eigen::VectorXd(a.diagonal()).cwiseQuotient(mass).maxCoeff();
  return largest > 0 ? largest : 1;
}

// Rounding's part of a pivot where K + D, each of unit size, has this diagonal.
Eigen::VectorXd least_pivots(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& mass) {
  return rounding * diagonal + global_rounding * mass;
}

SparseMatrix rows_and_columns(const SparseMatrix& a, const std::vector<int>& place, Eigen::Index size) {
  SparseMatrix part(size, size);
  part.reserve(a.nonZeros());
  for (Eigen::Index j = 0; j < a.outerSize(); ++j) {
    if (place[j] < 0) continue;
    part.startVec(place[j]);
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (place[it.row()] >= 0) part.insertBack(place[it.row()], place[j]) = it.value();
  }
  part.finalize();
  return part;
}

// A pivot is at most the diagonal's entry: what is rounding there, as sideways in a flat net, is held.
Resisted::Resisted(const StructuralMatrices& s) {
  const Eigen::VectorXd mass = s.mass.diagonal();
  sum = s.stiffness / unit_of(s.stiffness, mass);
  if (s.has_damping()) sum = SparseMatrix(sum + s.damping / unit_of(s.damping, mass));
  const Eigen::VectorXd diagonal = sum.diagonal();
  least_pivot = least_pivots(diagonal, mass);
  keep([&](Eigen::Index i) { return diagonal[i] > least_pivot[i]; });
}

// LDLᵀ of a semidefinite matrix, a row of L at a time along the elimination tree (Davis 2005, Algorithm 849),
// which holds an unknown for every rigid motion. A pivot is xᵀAx of the motion x that moves its unknown by 1,
// earlier ones so that this is least, and later ones not; it is compared with Σ r_i x_i², rounding's part of
// it.
class Pivots {
 public:
  Pivots(const SparseMatrix& matrix, const Eigen::VectorXd& r)
      : n_(static_cast<int>(matrix.rows())), columns_(n_), parent_(n_, -1), seen_(n_, -1), moves_(n_) {
    Eigen::AMDOrdering<int>()(matrix, order_);
    SparseMatrix a(n_, n_);
    a = matrix.twistedBy(order_.inverse());
    rounding_ = order_.inverse() * r;
    row_ = pivot_ = Eigen::VectorXd::Zero(n_);
    for (int k = 0; k < n_; ++k) {
      find_pattern(a, k);
      eliminate(k);
      moves_[k] =
          pivot_[k] > rounding_[k] && (pivot_[k] > sound * rounding_[k] || pivot_[k] > rounding_of_motion(k));
      for (const int i : reach_) {
        if (moves_[k] && moves_[i]) columns_[i].emplace_back(k, row_[i] / pivot_[i]);
        row_[i] = 0;
      }
    }
  }

  /// Which unknowns are not held.
  std::vector<bool> moving() const {
    std::vector<bool> found(n_);
    for (int k = 0; k < n_; ++k) found[order_.indices()[k]] = moves_[k];
    return found;
  }

 private:
  // Row k of the matrix, and the columns where row k of L has entries, from the end: each after those that it
  // depends on.
  void find_pattern(const SparseMatrix& a, int k) {
    reach_.clear();
    seen_[k] = k;
    for (SparseMatrix::InnerIterator it(a, k); it; ++it) {
      if (it.row() > k) continue;
      (it.row() == k ? pivot_[k] : row_[it.row()]) = it.value();
      path_.clear();
      for (int i = static_cast<int>(it.row()); seen_[i] != k; i = parent_[i]) {
        seen_[i] = k;
        path_.push_back(i);
        if (parent_[i] < 0) parent_[i] = k;
      }
      reach_.insert(reach_.end(), path_.rbegin(), path_.rend());
    }
  }

  void eliminate(int k) {
    for (auto i = reach_.rbegin(); i != reach_.rend(); ++i) {
      if (!moves_[*i]) continue;
      for (const auto& [j, l] : columns_[*i]) row_[j] -= l * row_[*i];
      pivot_[k] -= row_[*i] * row_[*i] / pivot_[*i];
    }
  }

  double rounding_of_motion(int k) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(k + 1);
    x[k] = 1;
    for (int i = k - 1; i >= 0; --i) {
      if (!moves_[i]) continue;
      x[i] = -row_[i] / pivot_[i];
      for (const auto& [j, l] : columns_[i]) x[i] -= l * x[j];
    }
    return x.cwiseAbs2().dot(rounding_.head(k + 1));
  }

  int n_;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
  std::vector<std::vector<std::pair<int, double>>> columns_;  // of L: row, value
  std::vector<int> parent_, seen_, path_, reach_;
  Eigen::VectorXd rounding_, row_, pivot_;  // r, of DLᵀ, and D
  std::vector<bool> moves_;
};

// Whether many unknowns that resist have pivots above their rounding, all of them, which a factorization by
// blocks finds out sooner: A - diag(r) ≻ 0 makes each pivot xᵀAx > Σ r_i x_i².
bool is_above(SparseMatrix a, const Eigen::VectorXd& least_pivot, const std::vector<int>& place) {
  if (a.rows() < SparseCholesky::blocked_from) return false;
  for (Eigen::Index i = 0; i < least_pivot.size(); ++i)
    if (place[i] >= 0) a.coeffRef(place[i], place[i]) -= least_pivot[i];
  return SparseCholesky().factorize(a);
}

StructuralMatrices part_of(const StructuralMatrices& s, const std::vector<int>& place, int size) {
  StructuralMatrices rest;
  rest.stiffness = rows_and_columns(s.stiffness, place, size);
  rest.mass = rows_and_columns(s.mass, place, size);
  if (s.has_damping()) rest.damping = rows_and_columns(s.damping, place, size);
  return rest;
}

}  // namespace

std::vector<bool> resisted_unknowns(const StructuralMatrices& s) {
  const Eigen::VectorXd mass = s.mass.diagonal();
  Eigen::VectorXd diagonal = s.stiffness.diagonal() / unit_of(s.stiffness, mass);
  if (s.has_damping()) diagonal += s.damping.diagonal() / unit_of(s.damping, mass);
  const Eigen::VectorXd least = least_pivots(diagonal, mass);
  std::vector<bool> resisted;
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) resisted.push_back(diagonal[i] > least[i]);
  return resisted;
}

StructuralMatrices without_rigid_motions(const StructuralMatrices& s) {
  Resisted r(s);
  if (!is_above(rows_and_columns(r.sum, r.place, r.size), r.least_pivot, r.place)) {
    const std::vector<bool> moving = Pivots(r.sum, r.least_pivot).moving();
    r.keep([&](Eigen::Index i) { return moving[i]; });
  }
  return part_of(s, r.place, r.size);
}

std::optional<StructuralMatrices> without_free_unknowns(const StructuralMatrices& s) {
  if (s.size() < SparseCholesky::blocked_from) return std::nullopt;
  const Resisted r(s);
  for (const int unknowns : {1, 3})  // a particle
    for (int axis = 0; axis < unknowns; ++axis) {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(s.size());
      for (Eigen::Index i = axis; i < s.size(); i += unknowns) x[i] = r.place[i] < 0 ? 0 : 1;
      if (x.any() && x.dot(r.sum * x) <= x.dot(r.least_pivot)) return std::nullopt;
    }
  return part_of(s, r.place, r.size);
}

}  // namespace springstab
