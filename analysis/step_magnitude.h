// What a method's step adds up: a bound on the rounding of its transition matrix.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

namespace springstab {

/// The transition matrix, 2n x 2n over (x, v), of one step of length 1 of x'' = -Kx - Dv with every term
/// taken as positive: |K|, |D| entry by entry, differences as sums, factors by their size. An entry computed
/// in floating point is off by at most a few roundings of it. Nothing for methods that need more of a system
/// than its accelerations.
std::optional<Eigen::MatrixXd> step_magnitude(std::string_view method, const Eigen::MatrixXd& stiffness,
                                              const Eigen::MatrixXd& damping);

}  // namespace springstab
