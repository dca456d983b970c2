// The motion of a linear system with Rayleigh damping in closed form, mode by mode.
//
//     const LinearMotion exact(prepare(stiffness, mass), 0.1, 1e-3, start);  // d0 [1/s], alpha [s]
//     const double moved = (exact.at(1.0).x - start.x).norm();
#pragma once

#include <cstdint>

#include "solvers/linear/structural_matrices.h"
#include "solvers/system.h"

namespace springstab {

/// Where an oscillator is, and its velocity.
struct OscillatorState {
  double q, v;
};

/// Of q'' + d q' + k q = 0, t [s] after the start; k [1/s²] of either sign, and d [1/s] >= -2√k where k > 0.
OscillatorState oscillator_motion(OscillatorState start, double k, double d, double t);

/// M x'' = -K x - (d0 M + alpha K) v from a start: with K V = M V Λ, Vᵀ M V = 1 and x = V q,
///     q'' + (d0 + alpha λ) q' + λ q = 0.
/// λ are Rayleigh quotients in extended precision, so that their error is that of V squared.
class LinearMotion {
 public:
  /// Dense, so O(n³). A `seed` other than 0 puts the unknowns in a random order first: the same motion by
  /// other roundings. Throws std::invalid_argument where no decomposition is found.
  LinearMotion(const StructuralMatrices& s, double d0, double alpha, const State<Vector>& start,
               std::uint64_t seed = 0);

  /// The state at time t [s] after the start.
  State<Vector> at(double t) const;

 private:
  Eigen::MatrixXd modes_;                    // V
  Vector squared_frequency_, damping_;       // λ [1/s²], d0 + alpha λ [1/s]
  Vector initial_place_, initial_velocity_;  // q and q' at the start
};

}  // namespace springstab
