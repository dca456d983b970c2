#include "analysis/limits/transient_growth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springstab {
namespace {

constexpr int line_samples = 256;  // of a line of modes
constexpr double forgotten = 0.1;  // a power this small beside the largest will not exceed it

double spectral_norm(const Eigen::Matrix2d& a) {
  return (std::hypot(a(0, 0) + a(1, 1), a(0, 1) - a(1, 0)) +
          std::hypot(a(0, 0) - a(1, 1), a(0, 1) + a(1, 0))) /
         2;
}

// Of methods that carry more, from the start of a run on: only x and v have an energy.
double growth_with_memory(const Method& method, double x, double y, long steps) {
  const Eigen::MatrixXd a = method.amplification(x, y);
  const double root = std::sqrt(y);
  Eigen::MatrixXd reached = method.starts(x, y);
  double largest = 1;
  for (long n = 0; n < steps; ++n) {
    reached = (a * reached).eval();
    Eigen::Matrix2d moved = reached.topRows<2>();
    moved(0, 1) *= root;
    moved(1, 0) /= root;
    const double norm = spectral_norm(moved);
    if (!std::isfinite(norm)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, norm);
    if (reached.norm() < forgotten * std::min(1.0, root)) break;
  }
  return largest;
}

}  // namespace

double transient_growth(const Method& method, double x, double y, long steps) {
  if (method.size() > 2) return growth_with_memory(method, x, y, steps);
  Eigen::Matrix2d a = method.amplification(x, y);
  const double root = std::sqrt(y);
  a(0, 1) *= root;
  a(1, 0) /= root;
  Eigen::Matrix2d power = Eigen::Matrix2d::Identity();
  double largest = 1;
  for (long n = 0; n < steps; ++n) {
    power = power * a;
    const double norm = spectral_norm(power);
    if (!std::isfinite(norm)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, norm);
    if (norm < forgotten) break;
  }
  return largest;
}

double transient_growth(const Method& method, const RayleighModes& modes, double h) {
  double largest = 1;
  for (int i = 1; i <= line_samples; ++i) {
    const double k = modes.k_min + (modes.k_max - modes.k_min) * i / line_samples;
    if (k > 0)
      largest = std::max(largest, transient_growth(method, h * (modes.d0 + modes.alpha * k), h * h * k));
  }
  return largest;
}

}  // namespace springstab
