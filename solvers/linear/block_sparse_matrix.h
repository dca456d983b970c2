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

  void set_zero();

  /// out = A in; both of length 3·rows(), not overlapping. Moves 76 bytes per block and 48 per row.
  void multiply(const double* in, double* out) const;

  Eigen::SparseMatrix<double> to_sparse() const;

 private:
  std::vector<long> row_start_;
  std::vector<int> column_;
  std::vector<long> diagonal_;
  std::vector<double> value_;
};

/// block += a I + b n nᵀ, with n a vector of 3: the shape of every spring's Jacobian.
inline void add_isotropic_and_axial(double* block, double a, double b, const double* n) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) block[3 * r + c] += (r == c ? a : 0.0) + b * (n[r] * n[c]);
}

}  // namespace springstab
