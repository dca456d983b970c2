#include "solvers/linear/block_sparse_matrix.h"

#include <algorithm>
#include <numeric>

namespace springstab {

BlockSparseMatrix::BlockSparseMatrix(SharedPattern pattern)
    : pattern_(std::move(pattern)), value_(9 * static_cast<std::size_t>(blocks()) + 1, 0.0) {
  sum_.setZero(4 * static_cast<long>(rows()));
}

void BlockSparseMatrix::set_zero() {
  constexpr double number_cost = 0.3;  // [ns]
  share_range(static_cast<long>(value_.size()), number_cost,
              [&](long first, long last) { std::fill(value_.begin() + first, value_.begin() + last, 0.0); });
}

void BlockSparseMatrix::multiply(const double* in, double* out) const {
  share_rows(in, [&](int i, const Eigen::Vector3d& y) {
    Eigen::Map<Eigen::Vector3d>(out + 3 * static_cast<long>(i)) = y;
  });
}

// As multiply_rows would.
void BlockSparseMatrix::add_from_below(const double* in, const RowPart& part) const {
  for (const RowPart::Below& below : part.below) {
    const double* const u = in + 3 * static_cast<long>(below.row);
    for (long k = below.last; k-- > below.first;) {
      const double* const b = value_.data() + 9 * k;
      const Four r0 = ConstFourAt(b), r1 = ConstFourAt(b + 3), r2 = ConstFourAt(b + 6);
      FourAt to(sum_.data() + 4 * static_cast<long>(column(k)));
      to += r0 * Four::Constant(u[0]) + r1 * Four::Constant(u[1]) + r2 * Four::Constant(u[2]);
    }
  }
}

void BlockSparseMatrix::scale(const Eigen::VectorXd& d) {
  for (int i = 0; i < rows(); ++i)
    for (long k = row_begin(i); k <= diagonal(i); ++k)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          double& entry = value_[9 * k + 3 * r + c];
          entry = d[3 * i + r] * entry * d[3 * column(k) + c];
        }
}

// Calls visit(row, column, value) for what is not zero, so that the rows of a column ascend.
template <class Visit>
void BlockSparseMatrix::visit_entries(const Visit& visit) const {
  for (int i = 0; i < rows(); ++i)
    for (long k = row_begin(i); k <= diagonal(i); ++k)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          if (const double v = value_[9 * k + 3 * r + c]; v != 0) {
            visit(3 * i + r, 3 * column(k) + c, v);
            if (column(k) != i) visit(3 * column(k) + c, 3 * i + r, v);
          }
}

// Without a list of all entries, which would take more than the matrix.
Eigen::SparseMatrix<double> BlockSparseMatrix::to_sparse() const {
  Eigen::SparseMatrix<double> matrix(3 * rows(), 3 * rows());
  std::vector<int> next(static_cast<std::size_t>(matrix.cols()) + 1, 0);  // of each column
  visit_entries([&](int, int column, double) { ++next[column + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::copy(next.begin(), next.end(), matrix.outerIndexPtr());
  matrix.resizeNonZeros(next.back());
  visit_entries([&](int row, int column, double value) {
    matrix.innerIndexPtr()[next[column]] = row;
    matrix.valuePtr()[next[column]++] = value;
  });
  return matrix;
}

std::optional<BlockSparseMatrix> in_blocks(const Eigen::SparseMatrix<double>& a) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  constexpr double block_bytes = 76, number_bytes = 12;
  if (a.rows() % 3 != 0) return std::nullopt;
  const int rows = static_cast<int>(a.rows()) / 3;
  const auto most = static_cast<long>(number_bytes / block_bytes * static_cast<double>(a.nonZeros())) - rows;
  std::vector<std::pair<int, int>> couplings;
  std::vector<int> below;
  for (int j = 0; j < rows; ++j) {
    if (std::ssize(couplings) > most) return std::nullopt;
    below.clear();
    for (int c = 3 * j; c < 3 * j + 3; ++c)
      for (Entry entry(a, c); entry; ++entry)
        if (const int i = static_cast<int>(entry.row()) / 3; i > j && (below.empty() || below.back() != i))
          below.push_back(i);
    std::ranges::sort(below);
    below.erase(std::unique(below.begin(), below.end()), below.end());
    for (const int i : below) couplings.emplace_back(i, j);
  }
  if (std::ssize(couplings) > most) return std::nullopt;
  BlockSparseMatrix in_blocks(rows, couplings);
  for (int c = 0; c < 3 * rows; ++c) {
    int row = -1;
    double* block = nullptr;
    for (Entry entry(a, c); entry; ++entry) {
      const int i = static_cast<int>(entry.row()) / 3;
      if (i < c / 3) continue;
      if (i != row) block = in_blocks.block(in_blocks.find(row = i, c / 3));
      block[3 * (entry.row() % 3) + c % 3] = entry.value();
    }
  }
  return in_blocks;
}

}  // namespace springstab
