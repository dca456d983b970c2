// Pairs of parts, each with a direction in which they were apart, found in any order and then sorted, by
// counting: in time proportional to their number.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace springstab {

struct KeptPair {
  std::array<int, 2> parts;
  Eigen::Vector3f normal;  // from the second to the first, of unit length but for rounding
};

class PairList {
 public:
  void clear() { pairs_.clear(); }
  void add(int i, int j, const Eigen::Vector3d& normal) { pairs_.push_back({{i, j}, normal.cast<float>()}); }
  /// By the first number, then by the second; both are below `count`.
  void sort(int count) {
    sort_by(1, count);
    sort_by(0, count);
  }
  auto begin() { return pairs_.begin(); }
  auto end() { return pairs_.end(); }
  std::size_t size() const { return pairs_.size(); }

 private:
  // Those with one number stay in the order they have.
  void sort_by(int which, int count) {
    begins_.assign(static_cast<std::size_t>(count) + 1, 0);
    for (const auto& pair : pairs_) ++begins_[pair.parts[which] + 1];
    for (int i = 0; i < count; ++i) begins_[i + 1] += begins_[i];
    sorted_.resize(pairs_.size());
    for (const auto& pair : pairs_) sorted_[begins_[pair.parts[which]]++] = pair;
    pairs_.swap(sorted_);
  }

  std::vector<KeptPair> pairs_, sorted_;
  std::vector<long> begins_;
};

}  // namespace springstab
