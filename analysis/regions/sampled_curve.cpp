#include "analysis/regions/sampled_curve.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/regions/amplification.h"
#include "analysis/regions/region_pieces.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

constexpr int a_decade = 30;
constexpr double nearest = 1e-10, farthest = 1e8;  // samples, of the centre's size

// -1 stable, +1 unstable, 0 neutral to rounding.
int fate(double radius) { return radius < 1 - known_radius ? -1 : radius > 1 + neutral_radius ? 1 : 0; }

}  // namespace

Bound binding_condition(const Method& method, double x, double y) {
  const Eigen::MatrixXd a = method.amplification(x, y);
  if (!a.allFinite()) return Bound::plus_one;
  std::complex<double> largest = 0;
  for (const std::complex<double> lambda : a.eigenvalues())
    if (std::abs(lambda) > std::abs(largest)) largest = lambda;
  if (std::abs(largest.imag()) > 1e-6 * std::abs(largest)) return Bound::complex_pair;
  return largest.real() > 0 ? Bound::plus_one : Bound::minus_one;
}

double SampledCurve::radius(double t) const {
  const double x = curve_.x(t), y = curve_.y(t);
  double rho = 0;
  method_->radii({&x, 1}, {&y, 1}, {&rho, 1});
  return rho;
}

std::vector<double> SampledCurve::samples(double t_min, double t_max) const {
  std::vector<double> centres = (curve_.x * curve_.x + Polynomial{{-4}} * curve_.y).real_roots();
  centres.push_back(0);
  std::vector<double> t;
  const auto add = [&](double at) {
    if (at > t_min && at < t_max) t.push_back(at);
  };
  const double ratio = std::pow(10, 1.0 / a_decade);
  for (const double centre : centres) {
    const double size = centre == 0 ? 1 : std::abs(centre);
    const double end = centre == 0 ? farthest : 10 * size;
    for (double distance = nearest * size; distance < end; distance *= ratio)
      add(centre - distance), add(centre + distance);
  }
  constexpr int across = 128;
  if (std::isfinite(t_max - t_min))
    for (int i = 1; i < across; ++i) add(t_min + (t_max - t_min) * i / across);
  std::sort(t.begin(), t.end());
  return t;
}

std::vector<Candidate> SampledCurve::candidates(double t_min, double t_max) const {
  const std::vector<double> t = samples(t_min, t_max);
  std::vector<double> x, y, rho(t.size());
  for (const double at : t) x.push_back(curve_.x(at)), y.push_back(curve_.y(at));
  method_->radii(x, y, rho);
  std::vector<Candidate> found;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const int before = fate(rho[i]);
    if (before == fate(rho[i + 1])) continue;
    double lower = t[i], upper = t[i + 1];
    for (double middle = between(lower, upper); middle > lower && middle < upper;
         middle = between(lower, upper))
      (fate(radius(middle)) == before ? lower : upper) = middle;
    const double at = std::abs(lower) < std::abs(upper) ? lower : upper;
    found.push_back({at, binding_condition(*method_, curve_.x(at), curve_.y(at))});
  }
  return found;
}

}  // namespace springstab
