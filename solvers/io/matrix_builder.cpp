#include "solvers/io/matrix_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

std::string position(long long row, long long column) {
  return "(" + std::to_string(row) + ", " + std::to_string(column) + ")";
}

}  // namespace

MatrixBuilder::MatrixBuilder(std::string source, int rows, int columns, Symmetry symmetry)
    : MatrixBuilder(std::move(source), rows, columns, symmetry, {0, rows}) {}

MatrixBuilder::MatrixBuilder(std::string source, int rows, int columns, Symmetry symmetry,
                             const IndexRange& own)
    : source_(std::move(source)), rows_(rows), columns_(columns), symmetry_(symmetry), own_(own) {}

void MatrixBuilder::add(long line, long long row, long long column, double value) {
  const Location at{source_, line};
  if (row < 1 || row > rows_ || column < 1 || column > columns_)
    at.fail("the entry " + position(row, column) + " lies outside the matrix, expected rows 1 to " +
            std::to_string(rows_) + " and columns 1 to " + std::to_string(columns_));
  if (symmetry_ == Symmetry::skew_symmetric && row == column) {
    if (value != 0)
      at.fail("the entry " + position(row, column) +
              " lies on the diagonal of a skew-symmetric matrix, expected nothing but 0 there");
    return;
  }
  if (symmetry_ != Symmetry::general && row < column) {  // the mirror image, in the lower triangle
    std::swap(row, column);
    if (symmetry_ == Symmetry::skew_symmetric) value = -value;
  }
  if (own_.holds(row - 1) || (symmetry_ != Symmetry::general && own_.holds(column - 1)))
    entries_.emplace_back(static_cast<int>(row - 1), static_cast<int>(column - 1), value, line);
}

/// entries_: sorted.
void MatrixBuilder::check_duplicates(Duplicates duplicates) const {
  double sum = 0;
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    const Entry &before = entries_[i - 1], &entry = entries_[i];
    const bool same = before.row() == entry.row() && before.col() == entry.col();
    sum = (same ? sum : 0) + before.value();
    if (!same || (duplicates == Duplicates::summed && std::isfinite(sum + entry.value()))) continue;
    Location{source_, entry.line}.fail(
        "a second entry " + position(entry.row() + 1LL, entry.col() + 1LL) +
        (symmetry_ == Symmetry::general ? "" : " or its mirror image") +
        (before.line == 0 ? "" : " after that of " + place_name(before.line)) +
        (duplicates == Duplicates::refused
             ? ", expected one entry per position (--sum-duplicates adds them up)"
             : ", expected that their sum fits in double precision"));
  }
}

void MatrixBuilder::sort_and_check(Duplicates duplicates) {
  const std::size_t listed = entries_.size();
  if (listed >
      std::numeric_limits<int>::max() / 2)  // Eigen counts entries with int, and mirroring doubles them
    Location{source_}.fail("the matrix has " + std::to_string(listed) + " entries, expected fewer than 2^30");
  const auto order = [](const Entry& e) { return std::tuple(e.col(), e.row(), std::abs(e.line)); };
  const auto before = [&order](const Entry& a, const Entry& b) { return order(a) < order(b); };
  if (!std::ranges::is_sorted(entries_, before)) std::ranges::sort(entries_, before);
  check_duplicates(duplicates);
}

void MatrixBuilder::mirror() {
  if (symmetry_ == Symmetry::general) return;
  const std::size_t listed = entries_.size();
  const double sign = symmetry_ == Symmetry::symmetric ? 1 : -1;
  entries_.reserve(2 * listed);
  for (std::size_t i = 0; i < listed; ++i)
    if (const Entry e = entries_[i]; e.row() != e.col())
      entries_.emplace_back(e.col(), e.row(), sign * e.value(), e.line);
}

MatrixRows MatrixBuilder::build_rows(Duplicates duplicates) && {
  sort_and_check(duplicates);
  mirror();
  std::erase_if(entries_, [this](const Entry& e) { return !own_.holds(e.row()); });
  for (Entry& e : entries_) e = Entry(e.row() - static_cast<int>(own_.first), e.col(), e.value(), e.line);
  MatrixRows rows{own_.first, rows_, columns_, {own_.last - own_.first, columns_}};
  rows.own.setFromTriplets(entries_.begin(), entries_.end());
  return rows;
}

Eigen::SparseMatrix<double> MatrixBuilder::build(Duplicates duplicates) && {
  sort_and_check(duplicates);
  mirror();
  Eigen::SparseMatrix<double> matrix(rows_, columns_);
  matrix.setFromTriplets(entries_.begin(), entries_.end());
  return matrix;
}

void check_rows(const Location& at, int rows, int columns, long long entries) {
  constexpr long long unquestioned = 1'000'000, rows_per_entry = 1000, largest = 50'000'000;
  const long long n = std::max(rows, columns);
  if (n > largest || (n > unquestioned && n / rows_per_entry > entries))
    at.fail("a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) + " with " +
            std::to_string(entries) + " entries, expected at most " + std::to_string(largest) +
            " rows and, beyond " + std::to_string(unquestioned) + ", an entry for every " +
            std::to_string(rows_per_entry));
}

}  // namespace springstab
