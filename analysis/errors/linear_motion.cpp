#include "analysis/errors/linear_motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

using Order = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic>;

Order order_of(Eigen::Index n, std::uint64_t seed) {
  Order order(n);
  order.setIdentity();
  std::mt19937_64 engine(seed);
  if (seed != 0) std::shuffle(order.indices().data(), order.indices().data() + n, engine);
  return order;
}

// uᵀ A u in extended precision.
long double quadratic_form(const SparseMatrix& a, const Eigen::MatrixXd::ColXpr& u) {
  long double sum = 0;
  for (Eigen::Index j = 0; j < a.outerSize(); ++j) {
    long double column = 0;
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      column += static_cast<long double>(it.value()) * static_cast<long double>(u[it.row()]);
    sum += column * static_cast<long double>(u[j]);
  }
  return sum;
}

}  // namespace

OscillatorState oscillator_motion(OscillatorState start, double k, double d, double t) {
  const double half = d / 2, square = k - half * half;
  if (square > 0) {
    const double omega = std::sqrt(square), decay = std::exp(-half * t);
    const double c = std::cos(omega * t), s = std::sin(omega * t) / omega;
    return {decay * (start.q * c + (start.v + half * start.q) * s),
            decay * (start.v * c - (k * start.q + half * start.v) * s)};
  }
  // e^(r t) with r = -half ± s, the slower one without cancellation; the faster one by its ratio to it.
  const double s = std::sqrt(-square), slow = half + s > 0 ? -k / (half + s) : 0;
  const double grown = std::exp(slow * t), mixed = start.v - slow * start.q;
  const double ratio = s > 0 ? -std::expm1(-2 * s * t) / (2 * s) : t;
  const double q = grown * (start.q + mixed * ratio);
  return {q, slow * q + grown * mixed * std::exp(-2 * s * t)};
}

LinearMotion::LinearMotion(const StructuralMatrices& s, double d0, double alpha, const State<Vector>& start,
                           std::uint64_t seed) {
  const Order order = order_of(s.size(), seed);
  const Eigen::MatrixXd k = order.transpose() * Eigen::MatrixXd(s.stiffness) * order;
  const Eigen::MatrixXd m = order.transpose() * Eigen::MatrixXd(s.mass) * order;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
  if (solver.info() != Eigen::Success)
    throw std::invalid_argument("the modes of the structure were not found, expected K and M symmetric");
  modes_ = order * solver.eigenvectors();
  squared_frequency_.resize(s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i)
    squared_frequency_[i] = static_cast<double>(quadratic_form(s.stiffness, modes_.col(i)) /
                                                quadratic_form(s.mass, modes_.col(i)));
  damping_ = (d0 + alpha * squared_frequency_.array()).matrix();
  initial_place_ = modes_.transpose() * (s.mass * start.x);
  initial_velocity_ = modes_.transpose() * (s.mass * start.v);
}

State<Vector> LinearMotion::at(double t) const {
  Vector q(modes_.cols()), v(modes_.cols());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const OscillatorState mode =
        oscillator_motion({initial_place_[i], initial_velocity_[i]}, squared_frequency_[i], damping_[i], t);
    q[i] = mode.q;
    v[i] = mode.v;
  }
  return {modes_ * q, modes_ * v};
}

}  // namespace springstab
