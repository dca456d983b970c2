// The motion that errors are measured against, and how far off it may be itself.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/studies/precision/problem.h"

namespace springstab {

/// Trajectories are compared at this many evenly spaced times after the start, the last of them the end.
inline constexpr int trajectory_samples = 16;

/// States at the start and at the times i duration / trajectory_samples.
using Trajectory = std::vector<State<Vector>>;

/// The errors of one trajectory against another, relative; norms are mass-weighted, ‖u‖² = uᵀMu.
struct Errors {
  double position = 0;    // at the end, of the largest ‖x(t) - x(0)‖ of the reference
  double velocity = 0;    // at the end, of the largest ‖v(t)‖
  double trajectory = 0;  // (Σ‖Δx‖² / Σ‖x - x(0)‖²)^½ over the samples
  double energy = 0;      // kinetic plus potential at the end, of the largest kinetic energy

  bool all_finite() const;
};

Errors errors_of(System& system, const Trajectory& run, const Trajectory& reference);

struct Reference {
  Trajectory trajectory;
  Errors error;                 // its own: the difference of two computations
  std::string method;           // how it was computed, for people
  std::optional<Errors> check;  // how far a third, unrelated integrator is away; nothing if it did not finish
};

struct ReferenceOptions {
  bool checked = true;                                       // by the third integrator
  double seconds = std::numeric_limits<double>::infinity();  // CPU, of an integration
};

inline constexpr char reference_check[] = "Bulirsch-Stoer, tolerance 1e-13";

/// Linear systems with Rayleigh damping or none, of up to 2000 unknowns, move as their modes do, and the
/// error is the difference to the same in another order of the unknowns. Everything else is integrated by
/// rk8pd with the tolerances 1e-10 and 1e-12, and the error is the difference of the two. Checked by
/// Boost.odeint's Bulirsch-Stoer where that was there when this was built, and gets through in two
/// CPU-minutes. Kept in the folder `cache` (empty: nowhere) under the problem's fingerprint. With the
/// problem's own damping, designed or not. Throws InputError where the integration does not finish or
/// nothing moves.
Reference reference_motion(Problem& problem, const std::string& cache, const ReferenceOptions& options = {});

/// A hash of what the problem does: its start, duration, masses, energies and accelerations there and at
/// states near it. Whatever changes the motion changes it.
std::string fingerprint(Problem& problem);

}  // namespace springstab
