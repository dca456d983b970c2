#include "solvers/linear/block_sparse_matrix.h"

#include <algorithm>

namespace springstab {

BlockSparseMatrix::BlockSparseMatrix(SharedPattern pattern)
    : pattern_(std::move(pattern)), value_(9 * static_cast<std::size_t>(blocks()) + 1, 0.0) {
  sum_.setZero(4 * static_cast<long>(rows()));
}

void BlockSparseMatrix::set_zero() { std::fill(value_.begin(), value_.end(), 0.0); }

void BlockSparseMatrix::multiply(const double* in, double* out) const {
  multiply_rows(in, [&](int i, const Eigen::Vector3d& y) {
    Eigen::Map<Eigen::Vector3d>(out + 3 * static_cast<long>(i)) = y;
  });
}

Eigen::SparseMatrix<double> BlockSparseMatrix::to_sparse() const {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(2 * value_.size());
  for (int i = 0; i < rows(); ++i)
    for (long k = row_begin(i); k <= diagonal(i); ++k)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (const double v = value_[9 * k + 3 * r + c]; v != 0) {
            triplets.emplace_back(3 * i + r, 3 * column(k) + c, v);
            if (column(k) != i) triplets.emplace_back(3 * column(k) + c, 3 * i + r, v);
          }
  Eigen::SparseMatrix<double> matrix(3 * rows(), 3 * rows());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace springstab
