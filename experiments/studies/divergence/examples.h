// Two small systems in which every step is stable by itself and the run explodes: frozen stability is not
// stability.
#pragma once

#include <optional>
#include <vector>

namespace springstab {

/// An oscillator whose stiffness changes from step to step: Y = h²k = 2.6 once and 3.9 three times in turn,
/// X = hd = Y + 0.01, by explicit Euler.
struct Switching {
  double radius_soft, radius_stiff;  // spectral radii of the single steps, below 1
  double growth;                     // of the state a step, over many periods
};
Switching switching_oscillator();

/// A mass of 1 kg on a spring of 1 m, let go at the height of its pivot, by linearized explicit Euler with
/// damping fitted to a step for 1.5 k0 and new linearizations every 0.05 s, and by symplectic Euler at the
/// same step without damping.
struct Pendulum {
  double step = 0;                       // [s]
  std::optional<double> exploded_at;     // the linearized run [s]
  double symplectic_largest_energy = 0;  // total, over 20 s, in units of m g l above the lowest point
  struct Sample {
    double t, linearized, symplectic;  // [s], distance from the pivot [m]
  };
  std::vector<Sample> samples;  // until the explosion
};
Pendulum swinging_pendulum();

}  // namespace springstab
