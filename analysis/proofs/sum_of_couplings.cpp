#include "analysis/proofs/sum_of_couplings.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

namespace springstab {
namespace {

// What a B may lack, of its diagonal: far above the rounding of three pivots, some 1e-15 of it, and of sums
// over a row of blocks.
constexpr double lack = 1e-10;

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

// B + lack diag(B) ⪰ 0, its pivots then at least about lack times its diagonal.
bool is_coupling(const Eigen::Matrix3d& b) {
  if (b != b.transpose()) return false;
  Eigen::Matrix3d more = b;
  more.diagonal() *= 1 + lack;
  return has_pivots(more, lack / 2);
}

}  // namespace

// Of [[B, -B], [-B, B]] with B ⪰ -lack diag(B) each half of the diagonal lacks 2 lack diag(B) at most.
// Rounding of the sums, entry by entry below 1e-13 √(s_rr s_cc), and of the pivots is in the other 2 lack
// diag(Σ B) and in lack diag(A_ii).
bool is_sum_of_couplings(const SparseMatrix& a) {
  if (a.rows() % 3 != 0 || !a.coeffs().allFinite()) return false;
  constexpr Eigen::Index none = std::numeric_limits<Eigen::Index>::max();
  for (Eigen::Index j = 0; j < a.cols(); j += 3) {
    SparseMatrix::InnerIterator column[] = {{a, j}, {a, j + 1}, {a, j + 2}};
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero(), sum = own;
    for (;;) {
      Eigen::Index next = none;
      for (const auto& entry : column)
        if (entry) next = std::min<Eigen::Index>(next, entry.row() / 3);
      if (next == none) break;
      Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
      for (int c = 0; c < 3; ++c)
        for (; column[c] && column[c].row() / 3 == next; ++column[c])
          block(column[c].row() % 3, c) = column[c].value();
      if (next == j / 3) {
        own = block;
        continue;
      }
      if (!is_coupling(-block)) return false;
      sum -= block;
    }
    if (own != own.transpose()) return false;
    Eigen::Matrix3d rest = own - sum;
    rest.diagonal() -= lack * own.diagonal().cwiseAbs() + 4 * lack * sum.diagonal();
    if (!has_pivots(rest, 0)) return false;
  }
  return true;
}

}  // namespace springstab
