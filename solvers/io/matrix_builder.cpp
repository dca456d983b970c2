#include "solvers/io/matrix_builder.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace springstab {
namespace {

std::string position(long long row, long long column) {
  return "(" + std::to_string(row) + ", " + std::to_string(column) + ")";
}

}  // namespace

MatrixBuilder::MatrixBuilder(std::string source, int rows, int columns, Symmetry symmetry)
    : source_(std::move(source)), rows_(rows), columns_(columns), symmetry_(symmetry) {}

void MatrixBuilder::add(long line, long long row, long long column, double value) {
  const Location at{source_, line};
  if (row < 1 || row > rows_ || column < 1 || column > columns_)
    at.fail("the entry " + position(row, column) + " lies outside the matrix, expected rows 1 to " +
            std::to_string(rows_) + " and columns 1 to " + std::to_string(columns_));
  if (symmetry_ == Symmetry::symmetric && row < column)
    at.fail("the entry " + position(row, column) +
            " lies above the diagonal, expected only the lower triangle of a symmetric matrix");
  if (symmetry_ == Symmetry::skew_symmetric && row <= column)
    at.fail("the entry " + position(row, column) +
            " does not lie below the diagonal, expected only entries that do in a skew-symmetric matrix");
  entries_.emplace_back(static_cast<int>(row - 1), static_cast<int>(column - 1), value, line);
}

Eigen::SparseMatrix<double> MatrixBuilder::build() && {
  const std::size_t listed = entries_.size();
  if (listed >
      std::numeric_limits<int>::max() / 2)  // Eigen counts entries with int, and mirroring doubles them
    Location{source_}.fail("the matrix has " + std::to_string(listed) + " entries, expected fewer than 2^30");
  const auto order = [](const Entry& e) { return std::tuple(e.col(), e.row(), e.line); };
  const auto before = [&order](const Entry& a, const Entry& b) { return order(a) < order(b); };
  if (!std::ranges::is_sorted(entries_, before)) std::ranges::sort(entries_, before);
  const auto same = [](const Entry& a, const Entry& b) { return a.row() == b.row() && a.col() == b.col(); };
  if (const auto twice = std::ranges::adjacent_find(entries_, same); twice != entries_.end())
    Location{source_, std::next(twice)->line}.fail(
        "a second entry " + position(twice->row() + 1LL, twice->col() + 1LL) + " after that of line " +
        std::to_string(twice->line) + ", expected one entry per position");
  if (symmetry_ != Symmetry::general) {
    const double sign = symmetry_ == Symmetry::symmetric ? 1 : -1;
    entries_.reserve(2 * listed);
    for (std::size_t i = 0; i < listed; ++i)
      if (const Entry e = entries_[i]; e.row() != e.col())
        entries_.emplace_back(e.col(), e.row(), sign * e.value(), e.line);
  }
  Eigen::SparseMatrix<double> matrix(rows_, columns_);
  matrix.setFromTriplets(entries_.begin(), entries_.end());
  return matrix;
}

}  // namespace springstab
