#include "solvers/linear/block_pattern.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace springstab {

BlockPattern::BlockPattern(int rows, std::span<const std::pair<int, int>> couplings) {
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
    bandwidth_ = std::max(bandwidth_, i - j);
  }
  for (int i = 0; i < rows; ++i) row_start_[i + 1] += row_start_[i];
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
