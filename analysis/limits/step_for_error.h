// How wrong a method will be, and the step that an error asks for: from the method's own amplification matrix
// on the modes of a motion. With A the matrix at (hd, h²k) and q(t) the exact motion of a mode, q(0) = q0,
//     error² = Σ |(Aⁿ (q0, hv))₁ - q(t)|² / Σ |q(t) - q0|²
// over all modes and over sixteen evenly spaced times t = nh, the last of them the end of the motion.
//
//     const MotionSpectrum motion = motion_spectrum(model, start, k0.value);
//     const auto found = step_for_error("rk4", motion, {.duration = 2, .error = 1e-3}, h_use);
//     if (found) std::cout << found->step << " s: error " << found->error << '\n';
#pragma once

#include <optional>

#include "analysis/limits/motion_spectrum.h"
#include "analysis/method.h"

namespace springstab {

/// Times at which errors are looked at.
inline constexpr long error_samples = 16;

struct ErrorGoal {
  double duration;  // over which [s]
  double error;     // relative to what moves
};

/// Of n steps from sample to sample; ∞ where the method's powers overflow.
double predicted_error(const Method& method, const MotionSpectrum& motion, double duration, long n);

struct StepForError {
  double step;        // duration / (error_samples n), n whole [s]
  double error;       // predicted
  bool by_stability;  // the error would allow for more than `largest_step`
};

/// The largest step, to 1 %, that is predicted to reach the goal; at most `largest_step` [s]. Nothing where
/// a billion steps would not.
std::optional<StepForError> step_for_error(const Method& method, const MotionSpectrum& motion,
                                           const ErrorGoal& goal, double largest_step);

}  // namespace springstab
