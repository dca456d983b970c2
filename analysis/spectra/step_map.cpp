#include "analysis/spectra/step_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "analysis/constants.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/spectra/transition_limit.h"
#include "analysis/spectra/transition_operator.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"

namespace springstab {
namespace {

using Complex = std::complex<double>;
using Complexes = std::vector<Complex>;

constexpr double neutral = 1e-4;  // |λ - 1| of motions that physics leaves alone
constexpr double outside = 1e-8;  // |λ| - 1 of what grows; differences are good to 1e-9
// What grows by less than `sharp` a step 1 % above, and by more than `differences` well below, as a power of
// h does, grows at every step.
constexpr double sharp = 1e-5, differences = 1e-9, well_below = 1.3;
// Times the largest rate of motion: steps from which accelerations are seen, and by which methods differ.
constexpr double small_step = 1e-3, telling_step = 1;
constexpr double longest = 1e12;  // times the first step
// Of D' beside √‖K'‖: differences of undamped steps, by which motions would seem to grow by themselves.
constexpr double no_damping = 1e-6;

double displacement(const Vector& x, double difference) {
  const double largest = x.lpNorm<Eigen::Infinity>();
  return difference * (largest > 0 ? largest : 1);
}

void check(const StepMap& map, const Vector& x, const Vector& v) {
  if (x.size() != map.size || v.size() != map.size || map.size < 1)
    throw std::invalid_argument("x and v have " + std::to_string(x.size()) + " and " +
                                std::to_string(v.size()) + " entries, expected " + std::to_string(map.size) +
                                " of each, at least 1");
  if (map.size > step_map_limit)
    throw std::invalid_argument("a state of " + std::to_string(map.size) + " unknowns, expected at most " +
                                std::to_string(step_map_limit));
}

struct Stepped {
  Vector x, v;
};

Stepped stepped(const StepMap& map, double h, Vector x, Vector v) {
  map.step(h, x, v);
  if (x.size() != map.size || v.size() != map.size)
    throw std::invalid_argument("the step gives x and v of " + std::to_string(x.size()) + " and " +
                                std::to_string(v.size()) + " entries, expected " + std::to_string(map.size));
  return {std::move(x), std::move(v)};
}

// The linearization over (x, hv): column j from ±δ in x_j, column n + j from ±δ/h in v_j.
Eigen::MatrixXd linearized(const StepMap& map, const Vector& x, const Vector& v, double h,
                           double difference) {
  const Eigen::Index n = map.size;
  const double delta = displacement(x, difference);
  Eigen::MatrixXd j(2 * n, 2 * n);
  for (Eigen::Index column = 0; column < 2 * n; ++column) {
    Vector dx = Vector::Zero(n), dv = Vector::Zero(n);
    (column < n ? dx[column] : dv[column - n]) = column < n ? delta : delta / h;
    const Stepped up = stepped(map, h, x + dx, v + dv), down = stepped(map, h, x - dx, v - dv);
    j.col(column) << (up.x - down.x) / (2 * delta), h * (up.v - down.v) / (2 * delta);
  }
  return j;
}

Complexes eigenvalues_of(const Eigen::MatrixXd& a) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a, false);
  if (solver.info() != Eigen::Success)
    throw std::runtime_error("the eigenvalues of the step did not converge");
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

// Of what does not count as neutral; ∞ where a step is not finite.
Complex largest_eigenvalue(const StepMap& map, const Vector& x, const Vector& v, double h,
                           double difference) {
  const Eigen::MatrixXd j = linearized(map, x, v, h, difference);
  if (!j.allFinite()) return infinity;
  Complex largest = 0;
  for (const Complex lambda : eigenvalues_of(j))
    if (std::abs(lambda - 1.0) > neutral && std::abs(lambda) > std::abs(largest)) largest = lambda;
  return largest;
}

// K' = -∂a/∂x and D' = -∂a/∂v of a = (v(h) - v)/h as h goes to zero, by extrapolation over h, h/2, h/4.
struct Accelerations {
  Eigen::MatrixXd stiffness, damping;
};

Accelerations accelerations(const StepMap& map, const Vector& x, const Vector& v, double h,
                            double difference) {
  const Eigen::Index n = map.size;
  const auto at = [&](double step) {
    const Eigen::MatrixXd j = linearized(map, x, v, step, difference);
    if (!j.allFinite())
      throw std::invalid_argument("the step at h = " + std::to_string(step) + " s is not finite");
    // Rows of h v: ∂(h v)/∂x = -h²K', ∂(h v)/∂(h v) = 1 - hD'.
    Eigen::MatrixXd both(n, 2 * n);
    both << -j.bottomLeftCorner(n, n) / (step * step),
        (Eigen::MatrixXd::Identity(n, n) - j.bottomRightCorner(n, n)) / step;
    return both;
  };
  const Eigen::MatrixXd a = at(h), b = at(h / 2), c = at(h / 4);
  const Eigen::MatrixXd ab = 2 * b - a, bc = 2 * c - b;
  const Eigen::MatrixXd limit = (4 * bc - ab) / 3;
  return {limit.leftCols(n), limit.rightCols(n)};
}

// The eigenvalues that a method's own step has on these matrices.
Complexes predicted(const Method& method, const StructuralMatrices& s, const Complexes& modes, double h) {
  Complexes values;
  if (method.info().implicit) {  // of a stability function, mode by mode
    for (const Complex mu : modes) {
      const Eigen::MatrixXd a = method.amplification(-2 * mu.real() * h, std::norm(mu) * h * h);
      for (const Complex lambda : eigenvalues_of(a)) values.push_back(lambda);
    }
    return values;
  }
  MatrixSystem system(s);
  const LinearOperator step = transition_operator(system, method, h);
  Eigen::MatrixXd j(step.size, step.size);
  Eigen::VectorXd out;
  for (Eigen::Index i = 0; i < step.size; ++i) {
    step.apply(Eigen::VectorXd::Unit(step.size, i), out);
    j.col(i) = out;
  }
  return eigenvalues_of(j);
}

double farthest_from(const Complexes& points, const Complexes& others) {
  double farthest_one = 0;
  for (const Complex point : points) {
    double distance = infinity;
    for (const Complex other : others) distance = std::min(distance, std::abs(point - other));
    farthest_one = std::max(farthest_one, distance);
  }
  return farthest_one;
}

}  // namespace

std::vector<Complex> step_eigenvalues(const StepMap& map, const Vector& x, const Vector& v, double h,
                                      double difference) {
  check(map, x, v);
  const Eigen::MatrixXd j = linearized(map, x, v, h, difference);
  if (!j.allFinite())
    throw std::invalid_argument("the step at h = " + std::to_string(h) + " s is not finite");
  return eigenvalues_of(j);
}

LargestStep largest_stable_step(const StepMap& map, const Vector& x, const Vector& v,
                                const StepMapOptions& options) {
  check(map, x, v);
  LargestStep found;
  const auto eigenvalue = [&](double h) {
    ++found.steps_tried;
    return largest_eigenvalue(map, x, v, h, options.difference);
  };
  const auto stable = [&](double h) { return std::abs(eigenvalue(h)) <= 1 + outside; };
  double low = options.first_step, high = low;
  if (stable(low)) {
    do {
      low = high;
      high *= 2;
      if (high > longest * options.first_step) {
        found.h_max = infinity;
        return found;
      }
    } while (stable(high));
  } else {
    do {
      high = low;
      low /= 2;
      if (low < options.first_step / longest) return found;
    } while (!stable(low));
  }
  while (high - low > options.accuracy * high) {
    const double middle = (low + high) / 2;
    (stable(middle) ? low : high) = middle;
  }
  found.leaves_at = eigenvalue(1.01 * low);
  found.radius_above = std::abs(found.leaves_at);
  if (found.radius_above > 1 + sharp || std::abs(eigenvalue(low / well_below)) <= 1 + differences) {
    // Where the eigenvalue leaves slowly it was outside before that could be told: back along its chord.
    const double left = found.radius_above - 1 - outside;
    found.h_max = left > outside ? low * (1 - 0.01 * outside / left) : low;
  }
  return found;
}

std::vector<MethodFit> methods_that_fit(const StepMap& map, const Vector& x, const Vector& v,
                                        const std::vector<Method>& methods, const StepMapOptions& options) {
  check(map, x, v);
  const auto matrices = [&](double h) {
    const Accelerations a = accelerations(map, x, v, h, options.difference);
    const bool damped = a.damping.norm() > no_damping * std::sqrt(a.stiffness.norm());
    return prepare_nonsymmetric(a.stiffness.sparseView(), {},
                                damped ? SparseMatrix(a.damping.sparseView()) : SparseMatrix());
  };
  const auto rate = [](const StructuralMatrices& s) {
    return std::max(std::sqrt(Eigen::MatrixXd(s.stiffness).norm()),
                    s.has_damping() ? Eigen::MatrixXd(s.damping).norm() : 0.0);
  };
  const double roughly = rate(matrices(1e-3 * options.first_step));
  if (!(roughly > 0)) return {};
  const StructuralMatrices s = matrices(small_step / roughly);
  const double h = telling_step / rate(s);
  const Complexes actual = step_eigenvalues(map, x, v, h, options.difference);
  const Complexes modes = generator_spectrum(s).value_or(Complexes());
  std::vector<MethodFit> fits;
  for (const Method& method : methods) {
    const bool mode_by_mode = stability_region(method).matrix_form() == MatrixForm::stability_function;
    if (method.info().implicit && !mode_by_mode) continue;
    const Complexes expected = predicted(method, s, modes, h);
    double distance = farthest_from(actual, expected);
    if (method.info().memory == 0) distance = std::max(distance, farthest_from(expected, actual));
    fits.push_back(
        {method, distance, mode_by_mode ? critical_step(method, modes) : transition_limit(method, s, modes)});
  }
  std::ranges::sort(fits, {}, &MethodFit::distance);
  return fits;
}

}  // namespace springstab
