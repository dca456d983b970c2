#include "analysis/regions/curve_conditions.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "analysis/regions/region_pieces.h"
#include "analysis/regions/sampled_curve.h"

namespace springstab {
namespace {

constexpr double cancellation = 1e-14;  // relative to the terms that cancel: a sign below it is not known
constexpr double neutrality =
    1e-12;  // a condition violated by less, relative to its terms, counts as neutral

constexpr std::array<Bound, 3> bounds{Bound::complex_pair, Bound::plus_one, Bound::minus_one};

}  // namespace

Condition::Condition(const RationalFunction& f, const Curve& curve, Bound b)
    : numerator(f.numerator().along(curve.x, curve.y)),
      denominator(f.denominator().along(curve.x, curve.y)),
      bound(b) {}

int Condition::sign(double t, double tolerance) const {
  double size = 0;
  for (std::size_t i = numerator.c.size(); i-- > 0;) size = size * std::abs(t) + std::abs(numerator.c[i]);
  const double value = numerator(t);
  if (std::abs(value) <= tolerance * size) return 0;
  return (value > 0) == (denominator(t) > 0) ? 1 : -1;
}

int Condition::sign_after_zero() const {
  const auto lowest = [](const Polynomial& p) {
    for (double c : p.c)
      if (c != 0) return c;
    return 0.0;
  };
  const double n = lowest(numerator), d = lowest(denominator);
  return n == 0 ? 0 : (n > 0) == (d > 0) ? 1 : -1;
}

CurveConditions::CurveConditions(const CharacteristicPolynomial& polynomial, const Curve& curve)
    : polynomial_(&polynomial), curve_(curve) {
  for (std::size_t i = 0; i < bounds.size(); ++i)
    conditions_.emplace_back(polynomial.conditions()[i], curve, bounds[i]);
}

CurveConditions::CurveConditions(const Method& method, const Curve& curve)
    : samples_(std::make_unique<const SampledCurve>(method, curve)), curve_(curve) {}

CurveConditions::~CurveConditions() = default;

double CurveConditions::radius(double t) const {
  return polynomial_ ? polynomial_->radius(curve_.x(t), curve_.y(t)) : samples_->radius(t);
}

std::vector<Candidate> CurveConditions::candidates(double t_min, double t_max) const {
  if (samples_) return samples_->candidates(t_min, t_max);
  std::vector<Candidate> found;
  const auto add = [&](const Polynomial& p, Bound bound) {
    for (double t : p.real_roots())
      if (t > t_min && t < t_max) found.push_back({t, bound});
  };
  for (const Condition& condition : conditions_) {
    add(condition.numerator, condition.bound);
    add(condition.denominator, condition.bound);
  }
  const Condition& pairs = conditions_.front();
  if (!jury() && pairs.numerator.is_zero()) add(polynomial_->discriminant(curve_), pairs.bound);
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.t < b.t; });
  return found;
}

bool CurveConditions::stable(double t) const {
  if (!jury()) return radius(t) < 1 - known_radius;
  return std::all_of(conditions_.begin(), conditions_.end(),
                     [&](const Condition& c) { return c.sign(t, cancellation) > 0; });
}

bool CurveConditions::unstable(double t) const {
  if (!jury()) return radius(t) > 1 + neutral_radius;
  return std::any_of(conditions_.begin(), conditions_.end(),
                     [&](const Condition& c) { return c.sign(t, neutrality) < 0; });
}

// Of two, both are outside where 1 - T + Δ and 1 + T + Δ are negative, as one is above 1 and one below -1, or
// where these are positive and 1 - Δ is negative.
bool CurveConditions::several_unstable(double t) const {
  if (!jury()) {
    const Eigen::VectorXd moduli = polynomial_->moduli(curve_.x(t), curve_.y(t));
    return (moduli.array() > 1 + neutral_radius).count() > 1;
  }
  const auto sign = [&](Bound bound) {
    return conditions_[static_cast<std::size_t>(bound)].sign(t, neutrality);
  };
  const int plus = sign(Bound::plus_one), minus = sign(Bound::minus_one);
  return (plus < 0 && minus < 0) || (plus > 0 && minus > 0 && sign(Bound::complex_pair) < 0);
}

bool CurveConditions::unstable_after_zero(double first) const {
  if (!jury()) {
    const double t = between(0, first);
    return unstable(t) ||
           (samples_ && !stable(t) && std::isfinite(first) && samples_->grows_from_zero(first));
  }
  return std::any_of(conditions_.begin(), conditions_.end(),
                     [](const Condition& c) { return c.sign_after_zero() < 0; });
}

bool CurveConditions::hold_on_unit_interval() const {
  if (!jury()) {
    std::vector<Candidate> cuts = candidates(0, 1);
    cuts.push_back({1, Bound::window});
    double from = 0;
    for (const Candidate& cut : cuts) {
      if (unstable(between(from, cut.t))) return false;
      from = cut.t;
    }
    return !unstable(0) && !unstable(1);
  }
  for (const Condition& condition : conditions_) {
    const Polynomial& n = condition.numerator;
    const Polynomial& d = condition.denominator;
    const Polynomial minus_one{{-1.0}};
    std::vector<double> extremes = (n.derivative() * d + minus_one * n * d.derivative()).real_roots();
    extremes.push_back(0);
    extremes.push_back(1);
    for (double t : extremes)
      if (t >= 0 && t <= 1 && !(condition(t) >= -10 * neutrality)) return false;
  }
  return true;
}

}  // namespace springstab
