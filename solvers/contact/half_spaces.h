// The nearest place in an intersection of half-spaces, exactly: a small quadratic program.
#pragma once

#include <Eigen/Core>
#include <span>

namespace springstab {

/// {w: n·w >= bound}, n a unit vector.
struct HalfSpace {
  Eigen::Vector3d normal;
  double bound;
  double multiplier = 0;  // r of the solution, >= 0
};

/// Moves w to the nearest place in all of them, w + Σ r n with 0 <= r ⟂ n·w - bound >= 0. At most three of
/// them are binding in the solution, so that trying which takes no iteration, however narrow a wedge they
/// form. Bounds are met to `rounding`, which has w's unit. False, and w and multipliers of no use, where they
/// have no common place.
bool project(std::span<HalfSpace> spaces, double rounding, Eigen::Vector3d& w);

}  // namespace springstab
