#include "analysis/spectra/generator_spectrum.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/constants.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/eigenvalue_refinement.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/undamped_motions.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

constexpr double rigid_rate = 1e-6, undamped = 1e-9;  // of the generator's rate and of the largest |μ|
constexpr double accurate = 1e-6;

using Modes = std::vector<std::complex<double>>;

// [[0, 1], [-K', -D']].
Eigen::MatrixXd first_order(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& damping) {
  const Eigen::Index n = stiffness.rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  matrix.topRightCorner(n, n).setIdentity();
  matrix.bottomLeftCorner(n, n) = -stiffness;
  matrix.bottomRightCorner(n, n) = -damping;
  return matrix;
}

double largest_of(const Modes& modes) {
  double largest = 0;
  for (const std::complex<double> mu : modes) largest = std::max(largest, std::abs(mu));
  return largest;
}

// Those of rounding's size beside the largest, one of each conjugate pair, and what they are in truth.
void refine(const StructuralMatrices& s, double rate, double largest, Modes& modes) {
  const auto in_doubt = [&](std::complex<double> mu) {
    return std::abs(mu.real()) <= undamped * largest || std::abs(mu) <= rigid_rate * rate;
  };
  if (std::none_of(modes.begin(), modes.end(), in_doubt)) return;
  const EigenvalueRefinement refinement(s, rate);
  Modes kept;
  for (const std::complex<double> mu : modes) {
    if (!in_doubt(mu)) {
      kept.push_back(mu);
    } else if (mu.imag() >= 0) {
      const RefinedEigenvalue refined = refinement.refine(mu);
      if (refined.rigid) continue;
      kept.push_back(refined.value);
      if (mu.imag() > 0) kept.push_back(std::conj(refined.value));
    }
  }
  modes = std::move(kept);
}

// The generator of what is left without the undamped motions; their eigenvalues, but of rigid ones.
Modes split_off_undamped(Generator& g) {
  const UndampedMotions undamped_motion = undamped_motions(g.stiffness, g.damping);
  const double rounding = 8 * unit_roundoff * static_cast<double>(g.stiffness.rows());  // of K', of norm 1
  Modes modes;
  for (const double lambda : undamped_motion.stiffness) {
    if (std::abs(lambda) <= rounding) continue;
    const std::complex<double> mu = g.rate * std::sqrt(std::complex<double>(-lambda));
    modes.insert(modes.end(), {mu, -mu});
  }
  if (undamped_motion.stiffness.size() > 0) {
    const Eigen::MatrixXd& q = undamped_motion.rest;
    g.matrix = first_order(q.transpose() * g.stiffness * q, q.transpose() * g.damping * q);
  }
  return modes;
}

}  // namespace

std::optional<Generator> dimensionless_generator(const StructuralMatrices& s) {
  const Eigen::Index n = s.size();
  if (n > generator_limit) return std::nullopt;
  Generator g;
  g.stiffness = as_dense(scaled_stiffness(s));
  g.damping = Eigen::MatrixXd::Zero(n, n);
  if (s.has_damping()) g.damping = as_dense(mass_scaled(s.damping, s.mass));
  if (s.symmetric) {
    g.stiffness = symmetric_part(g.stiffness);
    g.damping = symmetric_part(g.damping);
  }
  g.rate = std::sqrt(g.stiffness.norm());
  if (g.rate == 0) g.rate = g.damping.norm();
  if (!(g.rate > 0)) return std::nullopt;
  g.stiffness /= g.rate * g.rate;
  g.damping /= g.rate;
  g.matrix = first_order(g.stiffness, g.damping);
  return g;
}

std::optional<std::vector<std::complex<double>>> generator_spectrum(const StructuralMatrices& s) {
  std::optional<Generator> generator = dimensionless_generator(s);
  if (!generator) return std::nullopt;
  Modes undamped_modes;
  if (s.symmetric) undamped_modes = split_off_undamped(*generator);
  Modes modes;
  if (generator->matrix.size() > 0) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(generator->matrix, false);
    if (solver.info() != Eigen::Success) return std::nullopt;
    for (const std::complex<double> mu : solver.eigenvalues()) modes.push_back(generator->rate * mu);
    refine(s, generator->rate, std::max(largest_of(modes), largest_of(undamped_modes)), modes);
  }
  modes.insert(modes.end(), undamped_modes.begin(), undamped_modes.end());
  return modes;
}

std::optional<std::vector<DampedMode>> damped_modes(const StructuralMatrices& s) {
  const std::optional<Generator> generator = dimensionless_generator(s);
  if (!generator) return std::nullopt;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(generator->matrix);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXcd vectors = solver.eigenvectors().topRows(s.size());
  const double rate = generator->rate;
  std::vector<DampedMode> modes;
  for (Eigen::Index j = 0; j < vectors.cols(); ++j) {
    const std::complex<double> mu = solver.eigenvalues()[j];
    if (!(std::abs(mu) > rigid_rate)) continue;
    const Eigen::VectorXcd v = vectors.col(j).normalized();
    modes.push_back({rate * mu, rate * v.dot(generator->damping * v).real(),
                     rate * rate * v.dot(generator->stiffness * v).real()});
  }
  return modes;
}

double growth_rate(const std::vector<std::complex<double>>& modes) {
  double growth = 0;
  for (const std::complex<double> mu : modes) growth = std::max(growth, mu.real());
  return growth;
}

std::vector<std::complex<double>> modes_near(const StructuralMatrices& s, std::complex<double> shift,
                                             Eigen::Index count, const ArpackOptions& options) {
  using Complex = std::complex<double>;
  const Eigen::Index n = s.size();
  const double rate = std::abs(shift);  // makes time dimensionless
  const Complex sigma = shift / rate;
  const SparseMatrix k = s.stiffness / (rate * rate);
  const SparseMatrix d = s.has_damping() ? SparseMatrix(s.damping / rate) : SparseMatrix(n, n);
  const Eigen::SparseMatrix<Complex> shifted =
      (sigma * sigma * s.mass.cast<Complex>() + sigma * d.cast<Complex>() + k.cast<Complex>());
  Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factor;
  factor.isSymmetric(true);
  factor.compute(shifted);
  if (factor.info() != Eigen::Success) return {};
  // (C - σ)(x, v) = (a, b): v = a + σx and (σ²M + σD + K)x = -(Mb + Da + σMa).
  const LinearOperator inverse{2 * n, [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
                                 const Eigen::VectorXcd a = in.head(n).cast<Complex>();
                                 const Eigen::VectorXcd b = (in.tail(n) + sigma * a).eval();
                                 const Eigen::VectorXcd x = factor.solve(-(s.mass * b + d * a));
                                 out.resize(2 * n);
                                 out << x.real(), (a + sigma * x).real();
                               }};
  const Eigenvalues found = dominant_eigenvalues(inverse, count, options);
  std::vector<Complex> modes;
  for (Eigen::Index i = 0; i < found.vectors.cols(); ++i) {
    const Eigen::VectorXcd x = found.vectors.col(i).head(n);
    const Complex mu = x.dot(found.vectors.col(i).tail(n)) / x.squaredNorm();
    const Eigen::VectorXcd mass = mu * mu * (s.mass * x), damping = mu * (d * x), stiffness = k * x;
    if ((mass + damping + stiffness).norm() <= accurate * (mass.norm() + damping.norm() + stiffness.norm()))
      modes.push_back(rate * mu);
  }
  return modes;
}

std::optional<double> critical_step(const Method& method, const std::vector<std::complex<double>>& modes,
                                    double largest) {
  const StabilityRegion& region = stability_region(method);
  if (region.matrix_form() != MatrixForm::stability_function) return std::nullopt;
  double h = std::numeric_limits<double>::infinity();
  if (largest > 0) largest = std::max(largest, largest_of(modes));
  for (const std::complex<double> mu : modes) {
    // A real μ stands for the mode with the double root μ.
    const bool no_damping = std::abs(mu.real()) <= undamped * largest;
    const double d = no_damping ? 0 : -2 * mu.real();
    if (d < 0) continue;  // the motion itself grows
    const double limit = region.critical_step(std::norm(mu), d);
    if (no_damping && limit == 0) return std::nullopt;
    h = std::min(h, limit);
  }
  return h;
}

}  // namespace springstab
