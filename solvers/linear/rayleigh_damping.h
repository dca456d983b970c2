// The damping of the paper's Eq. 28. Includes nothing.
#pragma once

namespace springstab {

/// D = d0 M + alpha K (paper Eq. 28 times M).
struct RayleighDamping {
  double d0 = 0;     // [1/s]
  double alpha = 0;  // [s]
};

}  // namespace springstab
