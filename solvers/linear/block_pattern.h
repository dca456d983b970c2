// Where a symmetric matrix of blocks has some: the lower triangle, in compressed rows.
//
// Invariants: within a row the columns ascend and do not repeat; the last one is the diagonal block, which
// every row has.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace springstab {

/// Never changes. Matrices share one, and who has looked places up in it keeps it, to know it again by its
/// address.
class BlockPattern {
 public:
  /// `rows` block rows, with the diagonal and what each coupling (i, j) has below it.
  /// Throws std::invalid_argument for an index out of range.
  BlockPattern(int rows, std::span<const std::pair<int, int>> couplings);

  int rows() const { return static_cast<int>(row_start_.size()) - 1; }
  long blocks() const { return static_cast<long>(column_.size()); }

  /// The place of block (i, j), i >= j; throws std::out_of_range where there is none.
  long find(int i, int j) const;
  /// Row i has the places from row_begin(i) to diagonal(i).
  long row_begin(int i) const { return row_start_[i]; }
  long diagonal(int i) const { return row_start_[i + 1] - 1; }
  int column(long place) const { return column_[place]; }
  /// The largest i - j of a block (i, j).
  int bandwidth() const { return bandwidth_; }

  std::size_t bytes() const { return sizeof(int) * column_.size() + sizeof(long) * row_start_.size(); }

 private:
  friend class BlockSparseMatrix;  // its product walks the arrays
  std::vector<long> row_start_;
  std::vector<int> column_;
  int bandwidth_ = 0;
};

using SharedPattern = std::shared_ptr<const BlockPattern>;

}  // namespace springstab
