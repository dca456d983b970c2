// Which triangles cut each other: an edge of one, without a corner in common, passes through the other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

namespace springstab {

struct Cut {
  int first, second;  // triangles
  double depth;       // of the edge's end that is nearer to the other's plane [m]
};

/// The first triangle of `first` that one of `second` cuts, and the first that does. The lists may be the
/// same.
std::optional<Cut> first_cut(std::span<const std::array<int, 3>> first,
                             std::span<const std::array<int, 3>> second,
                             std::span<const Eigen::Vector3d> places);

}  // namespace springstab
