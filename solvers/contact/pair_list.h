// Pairs of numbers, found in any order and then sorted, by counting: in time proportional to their number.
#pragma once

#include <array>
#include <vector>

namespace springstab {

class PairList {
 public:
  void clear() { pairs_.clear(); }
  void add(int i, int j) { pairs_.push_back({i, j}); }
  /// By the first number, then by the second; both are below `count`.
  void sort(int count) {
    sort_by(1, count);
    sort_by(0, count);
  }
  auto begin() const { return pairs_.begin(); }
  auto end() const { return pairs_.end(); }
  std::size_t size() const { return pairs_.size(); }

 private:
  // Those with one number stay in the order they have.
  void sort_by(int which, int count) {
    begins_.assign(static_cast<std::size_t>(count) + 1, 0);
    for (const auto& pair : pairs_) ++begins_[pair[which] + 1];
    for (int i = 0; i < count; ++i) begins_[i + 1] += begins_[i];
    sorted_.resize(pairs_.size());
    for (const auto& pair : pairs_) sorted_[begins_[pair[which]]++] = pair;
    pairs_.swap(sorted_);
  }

  std::vector<std::array<int, 2>> pairs_, sorted_;
  std::vector<long> begins_;
};

}  // namespace springstab
