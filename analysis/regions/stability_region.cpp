#include "analysis/regions/stability_region.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "analysis/constants.h"
#include "analysis/per_method.h"
#include "analysis/regions/curve_conditions.h"
#include "analysis/regions/region_pieces.h"

namespace springstab {
namespace {

constexpr Eigen::Index largest_exact = 6;  // m up to which the polynomial's conditions serve

// Every seventh, with the first, the middle and the last.
std::vector<double> thinned(const std::vector<double>& line) {
  std::vector<double> kept;
  for (std::size_t i = 0; i < line.size(); i += 7) kept.push_back(line[i]);
  return kept;
}

}  // namespace

// u -> 4u / (1 - u²).
std::vector<double> whole_line() {
  constexpr int half = 400;
  std::vector<double> grid;
  for (int i = -half + 1; i < half; ++i) {
    const double u = static_cast<double>(i) / half;
    grid.push_back(4 * u / (1 - u * u));
  }
  return grid;
}

double between(double a, double b) {
  if (std::isfinite(a) && std::isfinite(b)) return a + (b - a) / 2;
  if (std::isfinite(a)) return 2 * std::abs(a) + 1;
  if (std::isfinite(b)) return -2 * std::abs(b) - 1;
  return 0;
}

double cosine_point(double left, double right, double angle) {
  return left + (right - left) * 0.5 * (1 - std::cos(angle));
}

StabilityRegion::StabilityRegion(const Method& method)
    : method_(method),
      by_values_(method.info().regions_by_values || method.size() > largest_exact),
      polynomial_(by_values_ ? std::vector<RationalFunction>(4, 0.0) : method.symbolic_step()),
      jury_(polynomial_.conditions()),
      matrix_form_(springstab::matrix_form(method, polynomial_)) {
  std::vector<double> line = whole_line();
  if (const double interval = critical_step(0, 1); by_values_ && std::isfinite(interval))  // X < twice that
    for (double& x : line) x *= std::max(1.0, 3 * interval / whole_line().back());
  if (method.size() > largest_exact) line = thinned(line);  // eigenvalues one matrix at a time
  all_pieces_ = smooth_pieces(line, -infinity, infinity);
  constants_ = find_constants();
}

StabilityRegion::StabilityRegion(StabilityRegion&&) noexcept = default;
StabilityRegion::~StabilityRegion() = default;

CurveConditions StabilityRegion::along(const Curve& curve) const {
  return by_values_ ? CurveConditions(method_, curve) : CurveConditions(polynomial_, curve);
}

std::vector<StableInterval> StabilityRegion::stable_intervals(const Curve& curve, double t_min,
                                                              double t_max) const {
  const CurveConditions conditions = along(curve);
  std::vector<Candidate> cuts = conditions.candidates(t_min, t_max);
  cuts.insert(cuts.begin(), {t_min, Bound::window});
  cuts.push_back({t_max, Bound::window});

  std::vector<StableInterval> found;
  bool touching = false;  // whether the previous gap was stable too: then nothing changed at this cut
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (i > 0 && cuts[i].t == cuts[i + 1].t) continue;  // a double root, where a condition may but touch zero
    const bool stable = cuts[i].t < cuts[i + 1].t && conditions.stable(between(cuts[i].t, cuts[i + 1].t));
    if (stable && touching) {
      found.back().upper = cuts[i + 1].t;
      found.back().upper_bound = cuts[i + 1].bound;
    } else if (stable) {
      found.push_back({cuts[i].t, cuts[i + 1].t, cuts[i].bound, cuts[i + 1].bound});
    }
    touching = stable;
  }
  return found;
}

double StabilityRegion::first_exit(const Curve& curve) const {
  const CurveConditions conditions = along(curve);
  const std::vector<Candidate> cuts = conditions.candidates(0, infinity);
  if (conditions.unstable_after_zero(cuts.empty() ? infinity : cuts.front().t)) return 0;
  for (std::size_t i = 0; i < cuts.size(); ++i)
    if (conditions.unstable(between(cuts[i].t, i + 1 < cuts.size() ? cuts[i + 1].t : infinity)))
      return cuts[i].t;
  return infinity;
}

double StabilityRegion::critical_step(double k, double d) const {
  if (!(k >= 0) || !(d >= 0) || !std::isfinite(k) || !std::isfinite(d))
    throw std::invalid_argument("critical_step: k = " + std::to_string(k) + ", d = " + std::to_string(d) +
                                ", expected both finite and not negative");
  const double rate = std::max(std::sqrt(k), d);  // [1/s], makes the curve dimensionless
  if (rate == 0) return infinity;
  const double s = std::sqrt(k) / rate;
  return first_exit({{{0, d / rate}}, {{0, 0, s * s}}}) / rate;
}

double StabilityRegion::critical_step_beside_growth(double k, double d) const {
  if (!(k < 0 || d < 0) || !std::isfinite(k) || !std::isfinite(d))
    throw std::invalid_argument("critical_step_beside_growth: k = " + std::to_string(k) +
                                ", d = " + std::to_string(d) + ", expected both finite and one negative");
  if (k >= 0) return infinity;
  if (by_values_) {  // the decaying motion as a mode of its own, with a double root
    if (matrix_form_ != MatrixForm::stability_function) return 0;
    const double root = std::hypot(d, 2 * std::sqrt(-k)), mu = d > 0 ? (d + root) / 2 : -2 * k / (root - d);
    return critical_step(mu * mu, 2 * mu);
  }
  const double rate = std::max(std::sqrt(-k), std::abs(d));  // [1/s]
  const double s = std::sqrt(-k) / rate;
  const CurveConditions conditions = along({{{0, d / rate}}, {{0, 0, -s * s}}});
  std::vector<Candidate> cuts = conditions.candidates(0, infinity);
  cuts.insert(cuts.begin(), {0, Bound::window});
  for (std::size_t i = 0; i < cuts.size(); ++i)
    if (conditions.several_unstable(between(cuts[i].t, i + 1 < cuts.size() ? cuts[i + 1].t : infinity)))
      return cuts[i].t / rate;
  return infinity;
}

StabilityRegion::Column StabilityRegion::column(double x, double y_min, double y_max) const {
  return {x, stable_intervals({{{x}}, {{0, 1}}}, y_min, y_max)};
}

bool StabilityRegion::same_conditions(const StabilityRegion& other) const {
  if (by_values_ || other.by_values_) return method_ == other.method_;
  return std::equal(jury_.begin(), jury_.end(), other.jury_.begin(),
                    [](const RationalFunction& f, const RationalFunction& g) {
                      return f.numerator() == g.numerator() && f.denominator() == g.denominator();
                    });
}

std::optional<HalfPlane> StabilityRegion::exact_condition() const {
  if (by_values_ || matrix_form_ != MatrixForm::scalar_coefficients || polynomial_.degree() != 2)
    return std::nullopt;
  const auto holds_on_quadrant = [](const std::array<double, 3>& c) {
    return std::all_of(c.begin(), c.end(), [](double v) { return v >= 0; });
  };
  const auto coefficients = affine_coefficients(polynomial_);
  if (!coefficients || !holds_on_quadrant(coefficients->back())) return std::nullopt;
  for (const Bound bound : {Bound::complex_pair, Bound::plus_one}) {
    const auto c = jury_[static_cast<std::size_t>(bound)].numerator().affine();
    if (!c || !holds_on_quadrant(*c)) return std::nullopt;
  }
  const auto c = jury_[static_cast<std::size_t>(Bound::minus_one)].numerator().affine();
  if (!c || !((*c)[0] > 0) || !((*c)[2] < 0)) return std::nullopt;
  return HalfPlane{-(*c)[1], -(*c)[2], (*c)[0]};
}

// Every x in (left.x, right.x) where the structure changes, to the last bit (by values to 1e-9), appended to
// `breaks`.
void StabilityRegion::find_breaks(Column left, const Column& right, double y_min, double y_max,
                                  std::vector<double>& breaks) const {
  const double width = by_values_ ? 1e-9 * std::max(1.0, std::abs(right.x)) : 1e-16;
  for (int i = 0; !left.same_structure(right); ++i) {
    if (i == 16 && by_values_) return;  // near X = 0, where a radius is 1 to rounding
    if (i == 16)
      throw std::runtime_error("the stability boundary near X = " + std::to_string(left.x) +
                               " could not be resolved");
    Column before = left, after = right;
    while (after.x - before.x > width) {
      const double x = between(before.x, after.x);
      if (x == before.x || x == after.x) break;
      Column middle = column(x, y_min, y_max);
      (middle.same_structure(left) ? before : after) = std::move(middle);
    }
    breaks.push_back(std::abs(before.x) < std::abs(after.x) ? before.x : after.x);
    left = std::move(after);
  }
}

std::vector<StabilityRegion::Piece> StabilityRegion::smooth_pieces(const std::vector<double>& grid,
                                                                   double y_min, double y_max) const {
  std::vector<double> breaks{grid.front()};
  Column left = column(grid.front(), y_min, y_max);
  for (std::size_t i = 1; i < grid.size(); ++i) {
    Column right = column(grid[i], y_min, y_max);
    find_breaks(std::move(left), right, y_min, y_max, breaks);
    left = std::move(right);
  }
  breaks.push_back(grid.back());

  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    if (breaks[i + 1] - breaks[i] <= 1e-12 * std::max(1.0, std::abs(breaks[i]))) continue;
    // A golden section, since two conditions may bind at once at round values of X.
    const double x = breaks[i] + (breaks[i + 1] - breaks[i]) / (1 + std::numbers::phi);
    Column inner = column(x, y_min, y_max);
    if (!inner.intervals.empty()) pieces.push_back({breaks[i], breaks[i + 1], std::move(inner)});
  }
  return pieces;
}

bool StabilityRegion::closed_segment_is_stable(double x0, double y0, double x1, double y1) const {
  return along({{{x0, x1 - x0}}, {{y0, y1 - y0}}}).hold_on_unit_interval();
}

const StabilityRegion& stability_region(const Method& method) {
  static PerMethod<StabilityRegion> regions;
  return regions.of(method, [&] { return StabilityRegion(method); });
}

}  // namespace springstab
