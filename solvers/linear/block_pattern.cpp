#include "solvers/linear/block_pattern.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace springstab {

// Columns are put into their rows, then sorted and made unique row by row: no list of pairs beside the one
// that is given.
BlockPattern::BlockPattern(int rows, std::span<const std::pair<int, int>> couplings) {
  row_start_.assign(rows + 1, 0);
  for (const auto& [i, j] : couplings) {
    if (i < 0 || j < 0 || i >= rows || j >= rows)
      throw std::invalid_argument("coupling (" + std::to_string(i) + ", " + std::to_string(j) +
                                  ") is outside a matrix of " + std::to_string(rows) + " block rows");
    ++row_start_[std::max(i, j) + 1];
  }
  for (int i = 0; i < rows; ++i) row_start_[i + 1] += row_start_[i] + 1;  // the diagonal
  column_.resize(row_start_.back());
  std::vector<long> next(row_start_.begin(), row_start_.end() - 1);
  for (const auto& [i, j] : couplings) column_[next[std::max(i, j)]++] = std::min(i, j);
  long end = 0;
  for (int i = 0; i < rows; ++i) {
    column_[next[i]++] = i;
    const auto first = column_.begin() + std::exchange(row_start_[i], end), last = column_.begin() + next[i];
    std::sort(first, last);
    end = std::copy(first, std::unique(first, last), column_.begin() + end) - column_.begin();
    bandwidth_ = std::max(bandwidth_, i - column_[row_start_[i]]);
  }
  row_start_[rows] = end;
  column_.resize(end);
  column_.shrink_to_fit();
}

long BlockPattern::find(int i, int j) const {
  const auto begin = column_.begin() + row_start_.at(i), end = column_.begin() + row_start_.at(i + 1);
  const auto found = std::lower_bound(begin, end, j);
  if (found == end || *found != j)
    throw std::out_of_range("block (" + std::to_string(i) + ", " + std::to_string(j) +
                            ") is not in the pattern");
  return found - column_.begin();
}

}  // namespace springstab
