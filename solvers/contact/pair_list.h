// Pairs of parts, each with a direction in which they were apart and until when that is clear without a look,
// found in any order and then sorted, by counting: in time proportional to their number.
// When is how far anything may have come nearer to anything else; pairs are looked after in blocks, so that
// those that are clear for long cost next to nothing.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace springstab {

struct KeptPair {
  std::array<int, 2> parts;
  Eigen::Vector3f normal;  // from the second to the first, of unit length but for rounding; or zero
  float clear_until = -std::numeric_limits<float>::infinity();  // [m]
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
  /// By the first number, then by the second; both are below `count`. After pairs have been added or removed.
  void sort(int count) {
    sort_by(1, count);
    sort_by(0, count);
    wakes_.assign((pairs_.size() + of_block - 1) / of_block, -std::numeric_limits<float>::infinity());
  }
  /// What was `now` is 0 from here on.
  void set_back(float now) {
    const float by = now * (1 + 4 * std::numeric_limits<float>::epsilon());
    for (KeptPair& pair : pairs_) pair.clear_until -= by;
    for (float& wakes : wakes_) wakes -= by;
  }
  /// Calls visit(pair) for those that are not clear until after `now`.
  template <class Visit>
  void for_each_from(float now, const Visit& visit) {
    for (std::size_t b = 0; b < wakes_.size(); ++b) {
      if (wakes_[b] > now) continue;
      wakes_[b] = std::numeric_limits<float>::infinity();
      const std::size_t end = std::min(pairs_.size(), (b + 1) * of_block);
      for (std::size_t i = b * of_block; i < end; ++i) {
        if (!(pairs_[i].clear_until > now)) visit(pairs_[i]);
        wakes_[b] = std::min(wakes_[b], pairs_[i].clear_until);
      }
    }
  }

 private:
  static constexpr std::size_t of_block = 64;

  // Those with one number stay in the order they have.
  void sort_by(int which, int count) {
    begins_.assign(static_cast<std::size_t>(count) + 1, 0);
    for (const KeptPair& pair : pairs_) ++begins_[pair.parts[which] + 1];
    for (int i = 0; i < count; ++i) begins_[i + 1] += begins_[i];
    sorted_.resize(pairs_.size());
    for (const KeptPair& pair : pairs_) sorted_[begins_[pair.parts[which]]++] = pair;
    pairs_.swap(sorted_);
  }

  std::vector<KeptPair> pairs_, sorted_;
  std::vector<long> begins_;
  std::vector<float> wakes_;  // of each block, when the first of its pairs is to be looked at
};

}  // namespace springstab
