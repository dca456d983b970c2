// Which boxes of a list meet each other, or those of a second list, by trees of boxes over both.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

namespace springstab {

/// Whether there are trees: Embree's, which is optional. Else BoxPairs throws std::runtime_error with
/// `embree_is_missing`.
bool has_embree();
inline constexpr const char* embree_is_missing =
    "self-contact and mesh obstacles need Embree (libembree-dev)";

/// Axis-parallel; the fourth number is 0, for whole registers.
struct Box {
  Eigen::Array4d low, high;

  bool meets(const Box& other) const {
    return (low - other.high).max(other.low - high).maxCoeff() <= 0;  // without a branch
  }
};

/// The number of boxes is fixed, so that a tree follows its boxes as they move, and is built anew now and
/// then.
class BoxPairs {
 public:
  /// Of `first` boxes with themselves, and where `second` is not 0 with `second` others instead.
  BoxPairs(int first, int second);
  ~BoxPairs();

  /// Calls visit(i, j) for i of the first list and j of the second, which count from where the first ends; or
  /// for i < j of the one list. All that meet are among them, each once, in no order that can be relied on,
  /// and some that do not.
  template <class Visit>
  void for_each(std::span<const Box> boxes, const Visit& visit) {
    for (const std::array<int, 2>& pair : find(boxes)) visit(pair[0], pair[1]);
  }

 private:
  const std::vector<std::array<int, 2>>& find(std::span<const Box> boxes);

  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace springstab
