// What a motion is made of: the modes of the linear system at its start, as far as the motion sees them. The
// linear system
//     M z'' = M a - K z - D z',   z(0) = 0,   z'(0) = v
// is projected on a few vectors that contain a and v: powers of K' = M⁻¹K for the fast parts of the motion
// and of (1 + τ²K')⁻¹ for the slow ones, orthonormal in the mass inner product. The projection's eigenpairs
// stand for the modes; there are as many as unknowns where those are few.
//
//     const MotionSpectrum motion = motion_spectrum(model, start, k0.value);
//     std::cout << "slowest period " << slowest_period(motion).value_or(0) << " s\n";
#pragma once

#include <optional>
#include <vector>

#include "analysis/model.h"

namespace springstab {

/// One mode: q'' + d q' + k q = acceleration, q(0) = 0, q'(0) = velocity, with mass 1. The square of a norm
/// √(uᵀMu) is the sum of the modes' squares.
struct MovingMode {
  double k, d;                    // [1/s², 1/s]
  double acceleration, velocity;  // √kg times [m/s², m/s]
};

struct MotionSpectrum {
  std::vector<MovingMode> modes;
  double k0;             // the structure's largest k [1/s²]
  DampingModel damping;  // where alpha is left to the design, d is not known before the step
  bool at_rest = false;  // nothing moves: what is described is the motion after a push, each a = 1 m/s²
};

/// Of a symmetric structure at `start`; `k0` is its largest k [1/s²]. Where D' does not commute with K', each
/// mode has its own uᵀDu and what couples the modes is left out.
MotionSpectrum motion_spectrum(Model& model, const State<Vector>& start, double k0);

/// Of the slowest mode that carries a hundredth of the motion's squared amplitude or more [s]; nothing where
/// all are motions that nothing brings back.
std::optional<double> slowest_period(const MotionSpectrum& motion);

}  // namespace springstab
