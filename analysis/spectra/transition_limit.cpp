#include "analysis/spectra/transition_limit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/constants.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/transition_operator.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"

namespace springstab {
namespace {

// Steps that are tried, over the time of the fastest motion: small ones, for what no step keeps stable; then
// those where limits lie.
constexpr double smallest_step = 1e-5, first_step = 1e-3, second_step = 3e-2, third_step = 0.2;
constexpr double further = 1.3, largest_step = 1e3;
constexpr double narrow = 1e-10, beside = 1e-6;

/// A(h) of the system in a time that is dimensionless, and how many of its eigenvalues are outside.
class Transition {
 public:
  Transition(const Method& method, const Generator& g, bool symmetric, long growing)
      : method_(method), system_(matrices(g, symmetric)), allowed_(growing) {}

  // All ∞ where the step cannot be solved for.
  Eigen::MatrixXd at(double h) {
    try {
      return as_dense(transition_operator(system_, method_, h));
    } catch (const std::runtime_error&) {
      const Eigen::Index size = method_.size() * system_.size();
      return Eigen::MatrixXd::Constant(size, size, infinity);
    }
  }

  double radius(double h) {
    return Eigen::EigenSolver<Eigen::MatrixXd>(at(h), false).eigenvalues().cwiseAbs().maxCoeff();
  }

  // Whether more are outside, beyond rounding, than grow by themselves. One of these that came inside is not
  // expected back.
  bool fails(double h) {
    const Eigen::MatrixXd a = at(h);
    if (!a.allFinite()) return true;
    Eigen::EigenSolver<Eigen::MatrixXd> solver(a, false);
    if (solver.info() != Eigen::Success) return true;
    const Eigen::ArrayXd excess = solver.eigenvalues().cwiseAbs().array() - 1;
    // Without their conditions eigenvalues are known to the root of rounding: of double ones.
    const double round_off = 8 * unit_roundoff * static_cast<double>(a.rows()) * a.norm();
    const double root = std::sqrt(round_off);
    if ((excess > root).count() > allowed_) return true;
    allowed_ = std::min<long>(allowed_, (excess > -root).count());
    if ((excess > 0).count() <= allowed_) return false;
    solver.compute(a, true);
    return (solver.eigenvalues().cwiseAbs().array() - 1 > errors(solver.eigenvectors(), round_off)).count() >
           allowed_;
  }

  // The sign of det(1 + A), which changes where an eigenvalue passes -1.
  bool turned(double h) {
    Eigen::MatrixXd a = at(h);
    a.diagonal().array() += 1;
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(a);
    bool negative = factor.permutationP().determinant() < 0;
    for (const double pivot : factor.matrixLU().diagonal()) negative ^= pivot < 0;
    return negative;
  }

 private:
  static StructuralMatrices matrices(const Generator& g, bool symmetric) {
    StructuralMatrices s;
    s.stiffness = g.stiffness.sparseView(0.0, 0.0);
    s.damping = g.damping.sparseView(0.0, 0.0);
    s.mass.resize(g.stiffness.rows(), g.stiffness.rows());
    s.mass.setIdentity();
    s.symmetric = symmetric;
    return s;
  }

  // Of each eigenvalue: rounding times its condition, ‖y‖‖x‖/|y*x|; of a double and defective one its root.
  static Eigen::ArrayXd errors(const Eigen::MatrixXcd& vectors, double round_off) {
    const Eigen::MatrixXcd left = vectors.partialPivLu().inverse();
    Eigen::ArrayXd error(vectors.cols());
    for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
      const double bound = round_off * left.row(i).norm() * vectors.col(i).norm();
      error[i] = bound < std::sqrt(round_off) ? bound : std::sqrt(round_off);  // also where it is not finite
    }
    return error;
  }

  Method method_;
  MatrixSystem system_;
  long allowed_;
};

// The first failing step between one that holds and one that fails.
double narrowed(Transition& transition, double holds, double fails) {
  if (const bool before = transition.turned(holds); transition.turned(fails) != before) {
    double low = holds, high = fails;
    while (high - low > 4 * unit_roundoff * high) {
      const double middle = low + (high - low) / 2;
      if (middle == low || middle == high) break;
      (transition.turned(middle) == before ? low : high) = middle;
    }
    if (!transition.fails(low * (1 - beside)) && transition.fails(high * (1 + beside))) return low;
  }
  while (fails - holds > narrow * fails) {
    const double middle = (holds + fails) / 2;
    (transition.fails(middle) ? fails : holds) = middle;
  }
  return holds;
}

}  // namespace

double undamped_limit(const Method& method, const std::vector<std::complex<double>>& modes) {
  double h = infinity;
  for (const std::complex<double> mu : modes)
    if (mu.real() == 0 && mu.imag() > 0)
      h = std::min(h, stability_region(method).critical_step(std::norm(mu), 0));
  return h;
}

std::optional<double> transition_limit(const Method& method, const StructuralMatrices& s,
                                       const std::vector<std::complex<double>>& modes) {
  if (method.info().implicit && !s.symmetric) return std::nullopt;
  if (method.size() > 2 && method.size() * s.size() > transition_limit_rows) return std::nullopt;
  const std::optional<Generator> g = dimensionless_generator(s);
  if (!g) return std::nullopt;
  double fastest = 0;
  for (const std::complex<double> mu : modes) fastest = std::max(fastest, std::abs(mu) / g->rate);
  if (fastest == 0) return infinity;
  const long growing = std::count_if(modes.begin(), modes.end(), [](auto mu) { return mu.real() > 0; });
  Transition transition(method, *g, s.symmetric, growing);
  const auto fails = [&](double step) { return transition.fails(step / fastest); };
  const auto limit = [&](double holds, double bad) {
    return narrowed(transition, holds / fastest, bad / fastest) / g->rate;
  };

  if (fails(first_step)) {
    for (double step = first_step / 10; step >= smallest_step * (1 - unit_roundoff); step /= 10)
      if (!fails(step)) return limit(step, 10 * step);
    const bool some_undamped =
        std::any_of(modes.begin(), modes.end(), [](auto mu) { return mu.real() == 0; });
    // What is far outside then is none of the motions, which are near 1.
    return some_undamped || transition.radius(smallest_step / fastest) > 1.01 ? std::optional(0.0)
                                                                              : std::nullopt;
  }
  double holds = first_step;
  for (double step = second_step; step < largest_step;
       step = step < third_step ? third_step : further * step) {
    if (fails(step)) return limit(holds, step);
    holds = step;
  }
  return infinity;
}

}  // namespace springstab
