// What is asked of the region as a whole: its highest point, how far it reaches along the axes, and the best
// line for Rayleigh damping.
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/constants.h"
#include "analysis/gsl/numerics.h"
#include "analysis/regions/region_pieces.h"
#include "analysis/regions/stability_region.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

constexpr double coincidence = 1e-5;  // the apex is known to about 1e-12, a double eigenvalue to its root

bool powers_bounded_2x2(const Eigen::MatrixXd& a) {
  const double mean = a.trace() / 2, half = (a(0, 0) - a(1, 1)) / 2;
  const double separation = std::sqrt(std::abs(half * half + a(0, 1) * a(1, 0)));  // |λ₁ - λ₂| / 2
  return separation >= coincidence || (a - mean * Eigen::Matrix2d::Identity()).norm() < coincidence;
}

// Of eigenvalues on the unit circle: those that coincide must have as many eigenvectors.
bool powers_bounded(const Eigen::MatrixXd& a) {
  if (a.rows() == 2) return powers_bounded_2x2(a);
  const Eigen::VectorXcd lambda = a.eigenvalues();
  for (const std::complex<double> at : lambda) {
    if (std::abs(at) < 1 - 1e-4) continue;
    const auto close = [&](std::complex<double> other) { return std::abs(other - at) < 10 * coincidence; };
    const auto multiplicity = std::count_if(lambda.begin(), lambda.end(), close);
    const Eigen::MatrixXcd rest = a - at * Eigen::MatrixXcd::Identity(a.rows(), a.rows());
    const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXcd>(rest).singularValues();
    if ((values.array() < 100 * coincidence).count() < multiplicity) return false;
  }
  return true;
}

}  // namespace

bool StabilityRegion::powers_bounded_at(double x, double y) const {
  return powers_bounded(method_.amplification(x, y));
}

RegionConstants StabilityRegion::find_constants() const {
  RegionConstants found{-infinity, std::numeric_limits<double>::quiet_NaN(), false, 0, 0, false};
  found.real_interval = critical_step(0, 1);
  found.imaginary_interval = critical_step(1, 0);
  for (const Piece& piece : all_pieces_) {
    const StableInterval& top = piece.inner.intervals.back();
    const auto [x, y] = top.upper == infinity ? std::pair{0.0, infinity} : highest_point(piece);
    if (y > found.y_max) found.y_max = y, found.x_at_y_max = x;
  }
  if (all_pieces_.empty()) found.y_max = 0;
  // Unbounded, too, where the top ends at a pole or still rises at the end of the line.
  const bool ends = by_values_ && std::isfinite(found.real_interval);
  const bool at_the_end = !ends && std::abs(found.x_at_y_max) >= whole_line().back();
  if (found.y_max > 1e12 || at_the_end) found.y_max = infinity;
  if (found.y_max == infinity) found.x_at_y_max = std::numeric_limits<double>::quiet_NaN();
  if (std::isfinite(found.x_at_y_max))
    found.y_max_attained = powers_bounded_at(found.x_at_y_max, found.y_max);
  found.covers_quadrant = std::any_of(all_pieces_.begin(), all_pieces_.end(), [](const Piece& piece) {
    const StableInterval& top = piece.inner.intervals.back();
    return piece.left <= 0 && piece.right >= whole_line().back() && top.lower <= 0 && top.upper == infinity;
  });
  return found;
}

// The top of a piece is a smooth graph Y(X) on a condition J = 0; inside, its maximum is where J_X = 0.
std::pair<double, double> StabilityRegion::highest_point(const Piece& piece) const {
  constexpr int samples = 64;
  const auto top = [&](double x) {
    const Column c = column(x, -infinity, infinity);
    return c.intervals.empty() ? -infinity : c.intervals.back().upper;
  };
  const double inset = 1e-15 * std::max(1.0, std::abs(piece.left) + std::abs(piece.right));
  std::vector<double> xs;
  for (int i = 0; i <= samples; ++i)
    xs.push_back(std::clamp(cosine_point(piece.left, piece.right, std::numbers::pi * i / samples),
                            piece.left + inset, piece.right - inset));
  std::vector<double> ys;
  for (double x : xs) ys.push_back(top(x));
  const auto best = static_cast<std::size_t>(std::max_element(ys.begin(), ys.end()) - ys.begin());
  if (best == 0 || best == samples) return {best == 0 ? piece.left : piece.right, ys[best]};

  if (by_values_) {
    double left = xs[best - 1], right = xs[best + 1];
    for (int i = 0; i < 60; ++i) {
      const double a = right - (right - left) / std::numbers::phi,
                   b = left + (right - left) / std::numbers::phi;
      (top(a) < top(b) ? left : right) = top(a) < top(b) ? a : b;
    }
    return {between(left, right), top(between(left, right))};
  }
  const auto bound = static_cast<std::size_t>(piece.inner.intervals.back().upper_bound);
  const BivariatePolynomial slope = jury_[bound].numerator().derivative_x();
  const auto steepness = [&](double x) { return slope(x, top(x)); };
  if (steepness(xs[best - 1]) * steepness(xs[best + 1]) > 0) return {xs[best], ys[best]};
  const double x = root_between(steepness, xs[best - 1], xs[best + 1]);
  return {x, top(x)};
}

DampingLine StabilityRegion::damping_line(double x0) const {
  const double apex_slope = (constants_.x_at_y_max - x0) / constants_.y_max;
  if (apex_slope >= 0 && closed_segment_is_stable(x0, 0, constants_.x_at_y_max, constants_.y_max))
    return {apex_slope, constants_.y_max};

  const auto reach = [&](double angle) {
    const double c = angle == 0 ? 0 : std::sin(angle), s = std::cos(angle);  // angle 0 points straight up
    return s * first_exit({{{x0, c}}, {{0, s}}});
  };
  constexpr int samples = 256;
  const double width = std::numbers::pi / 2 / samples;
  DampingLine best{0, reach(0)};
  double best_angle = 0;
  for (int i = 1; i < samples; ++i)
    if (const double y = reach(i * width); y > best.reach)
      best = {std::tan(i * width), y}, best_angle = i * width;
  if (best_angle == 0 || best.reach == infinity) return best;

  double lower = best_angle - width, upper = best_angle + width;  // golden section: the reach may jump
  for (int i = 0; i < 80; ++i) {
    const double a = upper - (upper - lower) / std::numbers::phi,
                 b = lower + (upper - lower) / std::numbers::phi;
    const double at_a = reach(a), at_b = reach(b);
    (at_a < at_b ? lower : upper) = at_a < at_b ? a : b;
    if (std::max(at_a, at_b) > best.reach) best = {std::tan(at_a > at_b ? a : b), std::max(at_a, at_b)};
  }
  return best;
}

}  // namespace springstab
