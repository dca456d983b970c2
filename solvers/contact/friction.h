// Coulomb friction as an impulse q on a particle of mass m that slides over an obstacle: |q| <= μ r, against
// the slip s that the step would end with, and never beyond stopping it. Energy falls for certain where q
// opposes the *mean* slip of the step, q·(s₋ + s + q/m) <= 0 with the slip s₋ that the step began with; along
// s that is |q| <= m (|s| + s₋·s/|s|), and only where the slip has turned round within the step is it less
// than stopping.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace springstab {

/// q [N·s] for slips s₋ and s [m/s] tangential to the obstacle and relative to it; `most` is μ r [N·s].
inline Eigen::Vector3d friction_impulse(double most, double mass, const Eigen::Vector3d& slip_before,
                                        const Eigen::Vector3d& slip) {
  const double speed = slip.norm();
  if (speed == 0) return Eigen::Vector3d::Zero();
  const double stops = mass * speed, opposes_mean = mass * (speed + slip_before.dot(slip) / speed);
  return -std::max(0., std::min({most, stops, opposes_mean})) / speed * slip;
}

/// The part of a velocity that is tangential to the unit vector.
inline Eigen::Vector3d tangential(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
  return v - normal.dot(v) * normal;
}

}  // namespace springstab
