// A method's conditions along one curve of the X-Y plane: where stability may change, and whether it holds
// between two such points. Shared by the files of StabilityRegion; not for others.
#pragma once

#include <memory>
#include <vector>

#include "analysis/regions/characteristic.h"
#include "analysis/regions/stability_region.h"

namespace springstab {

/// A computed |λ| is below 1 where it is so by the first, and above where by the second.
inline constexpr double known_radius = 1e-12, neutral_radius = 1e-10;

/// One of the three conditions along a curve.
struct Condition {
  Polynomial numerator, denominator;
  Bound bound;

  Condition(const RationalFunction& f, const Curve& curve, Bound b);
  double operator()(double t) const { return numerator(t) / denominator(t); }
  /// -1, 0, +1; zero where the value is below `tolerance` of the terms of the numerator.
  int sign(double t, double tolerance) const;
  /// The sign just after t = 0, from the lowest terms; 0 only where the condition is an equality throughout.
  int sign_after_zero() const;
};

/// A t at which stability may change.
struct Candidate {
  double t;
  Bound bound;
};

class SampledCurve;

class CurveConditions {
 public:
  /// The polynomial must outlive it.
  CurveConditions(const CharacteristicPolynomial& polynomial, const Curve& curve);
  /// From the radii of a method's steps, which must outlive it.
  CurveConditions(const Method& method, const Curve& curve);
  ~CurveConditions();

  /// All in (t_min, t_max), ascending.
  std::vector<Candidate> candidates(double t_min, double t_max) const;
  /// Whether every |λ| < 1 at t, which is no candidate.
  bool stable(double t) const;
  /// Whether some |λ| > 1 at t, by more than rounding.
  bool unstable(double t) const;
  /// Whether more than one |λ| > 1 at t, by more than rounding. Not for sampled conditions.
  bool several_unstable(double t) const;
  /// Whether some |λ| > 1 just after t = 0; `first` is the first candidate, or ∞.
  bool unstable_after_zero(double first) const;
  /// Whether no |λ| > 1 for t in [0, 1], by more than rounding.
  bool hold_on_unit_interval() const;

 private:
  bool jury() const { return polynomial_ && polynomial_->degree() == 2; }
  double radius(double t) const;

  const CharacteristicPolynomial* polynomial_ = nullptr;
  std::unique_ptr<const SampledCurve> samples_;  // where there is no polynomial
  Curve curve_;
  std::vector<Condition> conditions_;
};

}  // namespace springstab
