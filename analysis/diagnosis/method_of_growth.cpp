#include "analysis/diagnosis/method_of_growth.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "analysis/constants.h"
#include "analysis/spectra/spectrum.h"

namespace springstab::diagnosis {
namespace {

using Complex = std::complex<double>;

// What a factor and a quotient are off where modes grow side by side and the pose changes: k by 3 %, which
// near a limit is more of λ, and λ by 1 % beside that.
constexpr double stiffness_off = 0.03, factor_off = 0.01, most_off = 3, farthest = 0.1;
constexpr int samples = 40;  // of k, on both sides
constexpr double same_stiffness = 1e-3;
constexpr Eigen::Index stiffest_wanted = 6;

double quotient(const SparseMatrix& a, const SparseMatrix& mass, const Eigen::VectorXcd& u) {
  const auto times = [&](const SparseMatrix& m) {
    const Eigen::VectorXd re = u.real(), im = u.imag();
    return re.dot(m * re) + im.dot(m * im);
  };
  return times(a) / times(mass);
}

double damping_of_pattern(const Structure& structure, const Eigen::VectorXcd& u, double stiffness) {
  const auto& [matrices, damping, every_pose] = structure;
  if (damping.kind == DampingModel::Kind::general) return quotient(matrices.damping, matrices.mass, u);
  const bool known = damping.kind == DampingModel::Kind::rayleigh;
  return damping.d0 + (known ? damping.alpha : 0) * stiffness;
}

// |log(Λ/λ^m)|/m.
double distance(const RunFactor& run, Complex lambda) {
  if (!(std::abs(lambda) > 0)) return infinity;
  const Complex apart = std::log(run.factor) - static_cast<double>(run.every) * std::log(lambda);
  return std::hypot(apart.real(), std::remainder(apart.imag(), 2 * std::numbers::pi)) / run.every;
}

// The method's eigenvalue nearest to the run's.
Complex nearest(const Method& method, const RunFactor& run, double stiffness, double damping) {
  const Eigen::MatrixXd a = method.amplification(run.h * damping, run.h * run.h * stiffness);
  if (!a.allFinite()) return 0;
  Complex best = 0;
  for (const Complex lambda : a.eigenvalues())
    for (const Complex one : {lambda, std::conj(lambda)})
      if (distance(run, one) < distance(run, best)) best = one;
  return best;
}

MethodOfGrowth candidate(const Method& method, const RunFactor& run, double stiffness, double damping) {
  const auto at = [&](double times) { return nearest(method, run, times * stiffness, damping); };
  const Complex lambda = at(1);
  MethodOfGrowth found{method, lambda, distance(run, lambda), 1, infinity, false, {}};
  for (int i = -samples; i <= samples; ++i) {
    const double times = 1 + farthest * i / samples;
    const double off = std::hypot(distance(run, at(times)) / factor_off, (times - 1) / stiffness_off);
    if (off < found.off) found.off = off, found.stiffness = times;
  }
  found.fits = found.off < most_off;
  return found;
}

// Eigenvectors of S whose eigenvalues are k0's, to 0.1 %, in columns.
Eigen::MatrixXd stiffest_vectors(const StructuralMatrices& s) {
  const LinearOperator a = scaled_stiffness(s);
  Eigen::MatrixXd vectors;
  Eigen::VectorXd values;  // largest first
  if (a.size <= dense_limit) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(as_dense(a));
    values = solver.eigenvalues().reverse();
    vectors = solver.eigenvectors().rowwise().reverse();
  } else {
    const SymmetricEigenpairs pairs = largest_eigenpairs(a, stiffest_wanted, {.tolerance = 1e-6});
    values = Eigen::VectorXd::Map(pairs.values.data(), static_cast<Eigen::Index>(pairs.values.size()));
    vectors = pairs.vectors;
  }
  Eigen::Index count = 0;
  while (count < values.size() && values[count] >= (1 - same_stiffness) * values[0]) ++count;
  return vectors.leftCols(count);
}

// In the mass inner product.
std::optional<double> overlap(const StructuralMatrices& s, const Eigen::VectorXcd& u) {
  if (!s.symmetric || !is_diagonal(s.mass)) return std::nullopt;
  const Eigen::MatrixXd stiffest = stiffest_vectors(s);
  if (stiffest.cols() == 0) return std::nullopt;
  const Eigen::VectorXcd scaled =
      u.cwiseProduct(Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cast<Complex>());
  return (stiffest.transpose() * scaled).norm() / scaled.norm();
}

}  // namespace

PatternInStructure explain_growth(const Structure& pose, StructureLimits& answer,
                                  const Eigen::VectorXcd& pattern, const RunFactor& run,
                                  const std::vector<Method>& methods) {
  const StructuralMatrices& s = pose.matrices;
  if (pattern.size() != s.size())
    throw std::invalid_argument("the frames have " + std::to_string(pattern.size()) +
                                " unknowns, expected the structure's " + std::to_string(s.size()));
  const double k = quotient(s.stiffness, s.mass, pattern);
  const StiffestMode k0 = estimated_stiffest_mode(s);
  if (!k0.converged) throw std::runtime_error("the stiffness k0 in the frames' pose did not converge");
  PatternInStructure seen{k, damping_of_pattern(pose, pattern, k), k / k0.value, overlap(s, pattern), {}};
  for (const Method& method : methods) seen.methods.push_back(candidate(method, run, k, seen.damping));
  // Methods that take the same steps stay in their order.
  std::ranges::stable_sort(seen.methods, {}, [](const MethodOfGrowth& m) { return std::round(1e3 * m.off); });
  for (MethodOfGrowth& one : seen.methods)
    if (one.fits)
      if (const auto h_max = answer.limits(one.method).h_max; h_max && *h_max > 0 && std::isfinite(*h_max))
        one.step_over_limit = run.h / *h_max;
  return seen;
}

}  // namespace springstab::diagnosis
