// A square sparse matrix of 3x3 blocks, for the stiffness and damping of particle systems.
//
// Invariants: block rows are stored one after another (compressed rows); within a row the columns ascend and
// do not repeat; every diagonal block is stored; the pattern is symmetric. A block is 9 doubles, row by row.
// The pattern is fixed at construction, values change.
#pragma once

#include <Eigen/SparseCore>
#include <span>
#include <utility>
#include <vector>

namespace springstab {

class BlockSparseMatrix {
 public:
  /// `rows` block rows, with the diagonal and the blocks (i, j) and (j, i) of each coupling.
  /// Throws std::invalid_argument for an index out of range.
  BlockSparseMatrix(int rows, std::span<const std::pair<int, int>> couplings);

  int rows() const { return static_cast<int>(diagonal_.size()); }
  long blocks() const { return static_cast<long>(column_.size()); }

  /// Where block (i, j) is stored; throws std::out_of_range if it is not in the pattern.
  long find(int i, int j) const;
  double* block(long where) { return &value_[9 * where]; }
  const double* block(long where) const { return &value_[9 * where]; }
  long diagonal(int i) const { return diagonal_[i]; }
  /// The blocks of row i are those from row_begin(i) to before row_begin(i + 1).
  long row_begin(int i) const { return row_start_[i]; }
  int column(long where) const { return column_[where]; }

  /// What the matrix takes in memory.
  std::size_t bytes() const {
    return sizeof(double) * value_.size() + sizeof(int) * column_.size() +
           sizeof(long) * (row_start_.size() + diagonal_.size());
  }

  void set_zero();

  /// out = A in; both of length 3·rows(), not overlapping. Moves 76 bytes per block and 48 per row.
  void multiply(const double* in, double* out) const;

  /// The same, row by row in order: take(i, y) gets the three numbers of row i, so that what is done with the
  /// product needs no further pass over memory.
  template <class Take>
  void multiply_rows(const double* in, const Take& take) const;

  Eigen::SparseMatrix<double> to_sparse() const;

 private:
  std::vector<long> row_start_;
  std::vector<int> column_;
  std::vector<long> diagonal_;
  std::vector<double> value_;  // 9 per block, and one to read beyond the last
};

// Blocks are read by rows of four numbers, of which the last belongs to what follows: its product is dropped
// at the end of the row. Of the vector's last particle there is nothing to follow, it is read from a copy.
template <class Take>
void BlockSparseMatrix::multiply_rows(const double* in, const Take& take) const {
  using Four = Eigen::Array4d;
  using FourAt = Eigen::Map<const Four>;
  constexpr long ahead =
      256;  // numbers to prefetch, two kilobytes: the hardware alone reaches 80 % of the memory
  const int last = rows() - 1;
  const double* const in_last = in + 3 * static_cast<long>(last);
  const double copy[4] = {in_last[0], in_last[1], in_last[2], 0};
  const double* b = value_.data();
  for (int i = 0; i <= last; ++i) {
    Four s0 = Four::Zero(), s1 = s0, s2 = s0;
    for (long k = row_start_[i]; k < row_start_[i + 1]; ++k, b += 9) {
      __builtin_prefetch(b + ahead);
      __builtin_prefetch(b + ahead + 8);
      const int j = column_[k];
      const FourAt u(j == last ? copy : in + 3 * static_cast<long>(j));
      s0 += FourAt(b) * u;
      s1 += FourAt(b + 3) * u;
      s2 += FourAt(b + 6) * u;
    }
    take(i, Eigen::Vector3d(s0[0] + s0[1] + s0[2], s1[0] + s1[1] + s1[2], s2[0] + s2[1] + s2[2]));
  }
}

/// block += a I + b n nᵀ, with n a vector of 3: the shape of every spring's Jacobian.
inline void add_isotropic_and_axial(double* block, double a, double b, const double* n) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) block[3 * r + c] += (r == c ? a : 0.0) + b * (n[r] * n[c]);
}

}  // namespace springstab
