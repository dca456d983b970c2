// Pairs of parts, each with a direction in which they were apart and until when that is clear without a look,
// found in any order and then sorted, by counting: in time proportional to their number.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
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
  std::size_t size() const { return pairs_.size(); }
  template <class Is>
  void remove_if(const Is& is) {
    std::erase_if(pairs_, is);
  }
  /// By the first number, then by the second; both are below `count`. None is clear then.
  void sort(int count) {
    sort_by(1, count);
    sort_by(0, count);
    clear_until_.assign(pairs_.size(), -std::numeric_limits<float>::infinity());
  }
  /// Calls visit(pair, clear_until) for those that are not clear until after `now`.
  template <class Visit>
  void for_each_from(float now, const Visit& visit) {
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      if (!(clear_until_[i] > now)) visit(pairs_[i], clear_until_[i]);
  }

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
  std::vector<float> clear_until_;  // of each pair
  std::vector<long> begins_;
};

}  // namespace springstab
