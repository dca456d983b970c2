// Where a method may become unstable along a curve, from the spectral radii of its own steps alone: for
// methods whose formula in powers of X and Y has lost its digits, as that of a recurrence with many stages,
// and for those that carry so much that no determinant serves. Shared by the files of StabilityRegion; not
// for others.
//
// The radius is sampled geometrically around t = 0 and around each point of the parabola X² = 4Y, where the
// two eigenvalues of a mode's motion meet. An end is where |λ| = 1, to rounding; an interval is missed only
// if it is narrower than 8 % of its distance from the nearest of these points.
#pragma once

#include <vector>

#include "analysis/method.h"
#include "analysis/regions/curve_conditions.h"

namespace springstab {

class SampledCurve {
 public:
  /// The method must outlive it.
  SampledCurve(const Method& method, const Curve& curve) : method_(&method), curve_(curve) {}

  double radius(double t) const;
  std::vector<Candidate> candidates(double t_min, double t_max) const;
  /// Whether the growth begins at t = 0: neutral to rounding up to `first`, and hardly more just beyond.
  bool grows_from_zero(double first) const { return radius(1.1 * first) < 1 + 1e-8; }

 private:
  std::vector<double> samples(double t_min, double t_max) const;

  const Method* method_;
  Curve curve_;
};

/// Which condition an eigenvalue of largest modulus is nearest to.
Bound binding_condition(const Method& method, double x, double y);

}  // namespace springstab
