// What impulses could not part moves as one (the impact zones of Provot 1997, by translation): the nodes of a
// zone take the velocity of their mean momentum, or that of the obstacle in it. That is a projection in the
// mass norm, so that kinetic energy does not grow by it and momentum stays; and nothing in a zone comes
// nearer to anything else in it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace springstab {

class RigidZones {
 public:
  /// Every node by itself.
  explicit RigidZones(std::span<const double> inverse_mass);
  /// Whether they were not in one zone yet.
  bool join(const std::array<int, 4>& nodes);
  /// False, and the velocities of no use, where a zone holds nodes that are moved otherwise at different
  /// velocities.
  bool apply(std::span<Eigen::Vector3d> v);
  /// Of more than one node.
  long count();

 private:
  int root(int node);

  std::span<const double> inverse_mass_;
  std::vector<int> parent_;
};

}  // namespace springstab
