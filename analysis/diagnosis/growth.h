// A run that blows up, seen from its frames: from which one on it grows, by what factor, and what grows.
//
//     if (const auto growth = find_growth(frames))         // n x f, of any simulator, a column a frame
//       std::cout << "factor " << growth->factor << " from frame " << growth->from << '\n';
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

#include "analysis/diagnosis/growing_component.h"

namespace springstab::diagnosis {

struct Growth {
  std::complex<double>
      factor;  // Λ, from one frame to the next; its imaginary part >= 0, 0 where it never turns
  Eigen::VectorXcd pattern;  // φ, of unit norm: it is in the frames as Re(c Λⁿ φ)
  Eigen::Index from, to;     // frames in which its amplitude is c Λⁿ, to 25 %
  Eigen::Index first, last;  // the first of those that the pattern is from
  double e_foldings;         // over these frames
  double residual;           // of the frames that it was fitted to, relative
};

/// The columns before the first that is not finite, or is so large that squares overflow.
Eigen::Index usable_frames(const Frames& frames);

/// The first growth that is exponential over five e-foldings, eight where it is of one sign, as polynomials
/// of time may pass for that; nothing where there is none: then motion is bounded, decays, falls or is at
/// rest. Frames must be finite.
std::optional<Growth> find_growth(const Frames& frames);

}  // namespace springstab::diagnosis
