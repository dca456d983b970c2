#include "solvers/linear/block_sparse_matrix.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace springstab {

BlockSparseMatrix::BlockSparseMatrix(int rows, std::span<const std::pair<int, int>> couplings) {
  std::vector<std::pair<int, int>> entries;
  entries.reserve(rows + couplings.size());
  for (int i = 0; i < rows; ++i) entries.emplace_back(i, i);
  for (const auto& [i, j] : couplings) {
    if (i < 0 || j < 0 || i >= rows || j >= rows)
      throw std::invalid_argument("coupling (" + std::to_string(i) + ", " + std::to_string(j) +
                                  ") is outside a matrix of " + std::to_string(rows) + " block rows");
    entries.emplace_back(std::max(i, j), std::min(i, j));
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());

  row_start_.assign(rows + 1, 0);
  column_.reserve(entries.size());
  for (const auto& [i, j] : entries) {
    column_.push_back(j);
    ++row_start_[i + 1];
  }
  for (int i = 0; i < rows; ++i) row_start_[i + 1] += row_start_[i];
  value_.assign(9 * column_.size() + 1, 0.0);
  sum_.setZero(4 * static_cast<long>(rows));
}

long BlockSparseMatrix::find(int i, int j) const {
  const auto begin = column_.begin() + row_start_.at(i), end = column_.begin() + row_start_.at(i + 1);
  const auto found = std::lower_bound(begin, end, j);
  if (found == end || *found != j)
    throw std::out_of_range("block (" + std::to_string(i) + ", " + std::to_string(j) +
                            ") is not in the pattern");
  return found - column_.begin();
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
    for (long k = row_start_[i]; k < row_start_[i + 1]; ++k)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (const double v = value_[9 * k + 3 * r + c]; v != 0) {
            triplets.emplace_back(3 * i + r, 3 * column_[k] + c, v);
            if (column_[k] != i) triplets.emplace_back(3 * column_[k] + c, 3 * i + r, v);
          }
  Eigen::SparseMatrix<double> matrix(3 * rows(), 3 * rows());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace springstab
