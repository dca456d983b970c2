// Numbers that bounds and proofs are made with.
#pragma once

#include <limits>

namespace springstab {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

}  // namespace springstab
