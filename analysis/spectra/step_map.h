// Anybody's integrator, as the map (x, v) -> (x, v) one step later: how large its step may be, and which
// method it is. Nothing is asked of it but steps.
//
//     const StepMap mine{n, [&](double h, Vector& x, Vector& v) { my_engine.step(h, x, v); }};
//     const LargestStep largest = largest_stable_step(mine, rest, Vector::Zero(n));
//     const std::vector<MethodFit> fits = methods_that_fit(mine, rest, Vector::Zero(n), largest,
//     all_methods());
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/method.h"
#include "solvers/system.h"

namespace springstab {

struct StepMap {
  Eigen::Index size;  // of x and of v
  /// Replaces x and v by what they are h later. A function of these three alone. What it throws comes
  /// through.
  std::function<void(double h, Vector& x, Vector& v)> step;
};

struct StepMapOptions {
  /// Displacement of central differences, relative to the largest entry of x (to 1 where x is zero).
  /// Velocities are displaced by that over h.
  double difference = 1e-6;
  double first_step = 1e-3;  // tried; others follow by doubling or halving [s]
  double accuracy = 1e-7;    // of h_max, relative
};

/// Above as many unknowns the linearization is not formed.
inline constexpr Eigen::Index step_map_limit = 400;

/// All eigenvalues of the linearization at (x, v), over (x, hv), for steps of h. Throws std::invalid_argument
/// for a size that is not the map's, above `step_map_limit` or for a step that is not finite.
std::vector<std::complex<double>> step_eigenvalues(const StepMap& map, const Vector& x, const Vector& v,
                                                   double h, double difference);

struct LargestStep {
  /// Every smaller step tried keeps |λ| <= 1. ∞ where none that was tried did not, up to 1e12 first steps;
  /// nothing where the eigenvalues leave the unit circle with the smallest steps already, as for explicit
  /// Euler on undamped motion.
  std::optional<double> h_max;
  double radius_above = 0;             // largest |λ| at 1.01 h_max
  std::complex<double> leaves_at = 0;  // the eigenvalue that leaves the circle, there
  int steps_tried = 0;                 // values of h
};

/// Motions that physics leaves neutral have λ = 1, twice: eigenvalues within 1e-4 of 1 do not count.
LargestStep largest_stable_step(const StepMap& map, const Vector& x, const Vector& v,
                                const StepMapOptions& options = {});

/// Distance of eigenvalues below which a map's steps are a method's.
inline constexpr double same_eigenvalues = 1e-4;

struct MethodFit {
  Method method;
  double distance;              // of the map's eigenvalues from those of this method, the largest
  std::optional<double> h_max;  // of this method, for the same motions
};

/// How well each method explains the map at a third of its largest stable step, best first. K' and D' are
/// those of its accelerations as h goes to zero.
std::vector<MethodFit> methods_that_fit(const StepMap& map, const Vector& x, const Vector& v,
                                        const std::vector<Method>& methods,
                                        const StepMapOptions& options = {});

}  // namespace springstab
