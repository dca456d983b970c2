#include "analysis/generator_spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/spectrum.h"
#include "analysis/stability_region.h"

namespace springstab {
namespace {

constexpr double rigid = 1e-6, undamped = 1e-9;  // of √‖K'‖ and of the largest |μ|

// A function of the generator commutes with it; symplectic Euler's matrix does not.
bool has_stability_function(std::string_view method) {
  const double x = 0.3, y = 0.7;
  const Eigen::Matrix2d a = amplification_matrix(method, x, y), c{{0, 1}, {-y, -x}};
  return (a * c - c * a).norm() <= 1e-12 * a.norm();
}

}  // namespace

std::optional<std::vector<std::complex<double>>> generator_spectrum(const StructuralMatrices& s) {
  const Eigen::Index n = s.size();
  if (n > generator_limit) return std::nullopt;
  const Eigen::MatrixXd stiffness = symmetric_part(as_dense(scaled_stiffness(s)));
  const double rate = std::sqrt(stiffness.norm());  // makes time dimensionless
  if (!(rate > 0)) return std::nullopt;
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  generator.topRightCorner(n, n).setIdentity();
  generator.bottomLeftCorner(n, n) = -stiffness / (rate * rate);
  if (s.has_damping())
    generator.bottomRightCorner(n, n) = -symmetric_part(as_dense(mass_scaled(s.damping, s.mass))) / rate;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(generator, false);
  if (solver.info() != Eigen::Success) return std::nullopt;
  std::vector<std::complex<double>> modes;
  for (const std::complex<double> mu : solver.eigenvalues())
    if (std::abs(mu) > rigid) modes.push_back(rate * mu);
  return modes;
}

std::optional<double> critical_step(std::string_view method, const std::vector<std::complex<double>>& modes) {
  if (!has_stability_function(method)) return std::nullopt;
  const StabilityRegion& region = stability_region(method);
  double largest = 0, h = std::numeric_limits<double>::infinity();
  for (const std::complex<double> mu : modes) largest = std::max(largest, std::abs(mu));
  for (const std::complex<double> mu : modes) {
    // A real μ stands for the mode with the double root μ.
    const bool no_damping = std::abs(mu.real()) <= undamped * largest;
    const double d = no_damping ? 0 : -2 * mu.real();
    if (d < 0) return std::nullopt;
    const double limit = region.critical_step(std::norm(mu), d);
    if (no_damping && limit == 0) return std::nullopt;
    h = std::min(h, limit);
  }
  return h;
}

}  // namespace springstab
