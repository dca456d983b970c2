// Numbers that bounds and proofs are made with.
#pragma once

#include <Eigen/Core>
#include <limits>

namespace springstab {

/// From as many unknowns no more digits are computed than were asked for, and large blocks are factorized.
inline constexpr Eigen::Index many_unknowns = 20'000;

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

}  // namespace springstab
