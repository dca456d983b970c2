#include "analysis/proofs/sum_of_couplings.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "analysis/constants.h"
#include "analysis/spectra/rigid_motions.h"

namespace springstab {
namespace {

// What a B may lack, of its diagonal: far above the rounding of three pivots, some 1e-15 of it, and of sums
// over a row of blocks.
constexpr double lack = 1e-12;
constexpr double added = 2e-11;  // of D's diagonal
constexpr double any = 1e200;    // a ratio beyond all

// Whether pivots of m are above `least` of its diagonal; where that is 0, rows must be.
bool has_pivots(Eigen::Matrix3d m, double least) {
  const Eigen::Vector3d diagonal = m.diagonal();
  for (int k = 0; k < 3; ++k) {
    if (diagonal[k] == 0 && m.row(k).isZero(0) && m.col(k).isZero(0)) continue;
    const double pivot = m(k, k);
    if (!(diagonal[k] > 0 && pivot > least * diagonal[k])) return false;
    for (int i = k + 1; i < 3; ++i)
      for (int j = k + 1; j < 3; ++j) m(i, j) -= m(i, k) / pivot * m(k, j);  // whose product may underflow
  }
  return true;
}

// Blocks of P and Q, of which P - ρ Q is asked.
struct Pair {
  Eigen::Matrix3d p = Eigen::Matrix3d::Zero(), q = p;

  Eigen::Matrix3d at(double ratio) const {
    if (q.isZero(0)) return p;
    return p - ratio * q;
  }
  bool is_symmetric() const { return p == p.transpose() && q == q.transpose(); }
};

// The diagonal's absolute values, of P and Q by themselves: what rounding is measured by.
struct Size {
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), q = p;

  Size() = default;
  explicit Size(const Pair& block) : p(block.p.diagonal().cwiseAbs()), q(block.q.diagonal().cwiseAbs()) {}
  Eigen::Vector3d at(double ratio) const { return p + ratio * q; }
};

// B + lack diag(B) ⪰ 0, its pivots then at least about lack times its diagonal.
bool is_coupling(const Pair& b, double ratio) {
  Eigen::Matrix3d more = b.at(ratio);
  more.diagonal() += lack * Size(b).at(ratio);
  return has_pivots(more, lack / 2);
}

// Of [[B, -B], [-B, B]] with B ⪰ -lack diag(B) each half of the diagonal lacks 2 lack diag(B) at most.
// Rounding of the sums, entry by entry below 1e-13 √(s_rr s_cc), and of the pivots is in the other 2 lack
// diag(Σ B) and in lack diag(A_ii).
struct Diagonal {
  Pair own{}, couplings{};
  Size couplings_size{};
  double more = 0;  // of P's diagonal

  bool has_rest(double ratio) const {
    Eigen::Matrix3d rest = own.at(ratio) - couplings.at(ratio);
    rest.diagonal() +=
        more * own.p.diagonal() - lack * Size(own).at(ratio) - 4 * lack * couplings_size.at(ratio);
    return has_pivots(rest, 0);
  }
};

// The largest ratio up to `most` that `holds`: where 0 does, all below it do. P - ρ Q has no diagonal beyond
// `bound`.
template <class Holds>
std::optional<double> largest(double most, const Pair& bound, const Holds& holds) {
  if (!holds(0)) return std::nullopt;
  if (holds(most)) return most;
  double low = 0, high = most;
  for (int r = 0; r < 3; ++r)
    if (bound.q(r, r) > 0) high = std::min(high, 2 * bound.p(r, r) / bound.q(r, r));
  for (int halvings = 0; halvings < 60 && high - low > 1e-9 * high; ++halvings) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low * (1 - 1e-9);  // room for the rounding of its like
}

// Three columns of a matrix, of which some unknowns move, block by block.
class BlockColumn {
 public:
  BlockColumn(const SparseMatrix& a, const std::vector<bool>& moves, Eigen::Index j)
      : moves_(moves), first_(j), columns_{{{a, j}, {a, j + 1}, {a, j + 2}}} {}

  // The row of the next block; after the last the largest number.
  Eigen::Index row() const {
    Eigen::Index first = std::numeric_limits<Eigen::Index>::max();
    for (const auto& entry : columns_)
      if (entry) first = std::min<Eigen::Index>(first, entry.row() / 3);
    return first;
  }
  bool ended() const { return !columns_[0] && !columns_[1] && !columns_[2]; }
  // The block of that row, if it is the next.
  Eigen::Matrix3d take(Eigen::Index row) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (int c = 0; c < 3; ++c)
      for (auto& entry = columns_[c]; entry && entry.row() / 3 == row; ++entry)
        if (moves_[first_ + c] && moves_[entry.row()]) block(entry.row() % 3, c) = entry.value();
    return block;
  }

 private:
  const std::vector<bool>& moves_;
  Eigen::Index first_;
  std::array<SparseMatrix::InnerIterator, 3> columns_;
};

std::optional<double> largest_ratio(const SparseMatrix& p, const SparseMatrix& q,
                                    const std::vector<bool>& moves, IndexRange columns, double more) {
  if (p.rows() % 3 != 0 || !p.coeffs().allFinite() || !q.coeffs().allFinite()) return std::nullopt;
  std::optional<double> ratio = any;
  for (Eigen::Index j = columns.first; ratio && j < columns.last; j += 3) {
    Diagonal diagonal{.more = more};
    for (BlockColumn of_p(p, moves, j), of_q(q, moves, j); ratio && !(of_p.ended() && of_q.ended());) {
      const Eigen::Index row = std::min(of_p.row(), of_q.row());
      Pair block{of_p.take(row), of_q.take(row)};
      if (!block.is_symmetric()) return std::nullopt;
      if (row == j / 3) {
        diagonal.own = block;
        continue;
      }
      block = {-block.p, -block.q};
      ratio = largest(*ratio, block, [&](double r) { return is_coupling(block, r); });
      diagonal.couplings.p += block.p, diagonal.couplings.q += block.q;
      diagonal.couplings_size.p += Size(block).p, diagonal.couplings_size.q += Size(block).q;
    }
    if (ratio) ratio = largest(*ratio, diagonal.own, [&](double r) { return diagonal.has_rest(r); });
  }
  return ratio;
}

}  // namespace

bool is_sum_of_couplings(const SparseMatrix& a) {
  const std::vector<bool> all(static_cast<std::size_t>(a.cols()), true);
  return largest_ratio(a, SparseMatrix(a.rows(), a.cols()), all, {0, a.cols()}, 0).has_value();
}

std::optional<double> coupling_ratio(const StructuralMatrices& s, IndexRange columns) {
  if (columns.first == columns.last) return infinity;
  if (!s.has_damping()) return std::nullopt;
  const std::optional<double> ratio =
      largest_ratio(s.damping, s.stiffness, resisted_unknowns(s), columns, added);
  return ratio && *ratio == any ? infinity : ratio;
}

}  // namespace springstab
