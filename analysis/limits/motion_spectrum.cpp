#include "analysis/limits/motion_spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springstab {
namespace {

constexpr Eigen::Index most_vectors = 32, least_vectors = 8;
constexpr Eigen::Index most_numbers = 20'000'000;  // that the vectors may have together
constexpr double dependent = 1e-10;                // of a vector's norm: what is left of it is rounding
constexpr double still = 1e-12;                    // of k0 ‖x‖: forces this small are rounding
constexpr double slow_and_fast = 1e6;              // τ² in units of 1/k0
constexpr double nothing_brings_back = 1e-13;      // of k0: less is rounding
constexpr double carries = 0.01;

/// Vectors that are orthonormal in the mass inner product.
class MassBasis {
 public:
  MassBasis(const SparseMatrix& mass, Eigen::Index most) : mass_(mass), vectors_(mass.rows(), most) {}

  auto vectors() const { return vectors_.leftCols(size_); }
  Eigen::Index size() const { return size_; }
  bool is_full() const { return size_ == vectors_.cols(); }
  double norm(const Vector& u) const { return std::sqrt(u.dot(mass_ * u)); }
  /// Of a vector, along the basis.
  Vector coefficients(const Vector& u) const { return vectors().transpose() * (mass_ * u); }

  /// Takes in what u has beyond the basis; false where that is nothing or there is no more room.
  bool append(Vector u) {
    const double whole = norm(u);
    if (is_full() || !(whole > 0) || !std::isfinite(whole)) return false;
    u /= whole;
    for (int pass = 0; pass < 2; ++pass) u -= vectors() * coefficients(u);
    const double rest = norm(u);
    if (!(rest > dependent)) return false;
    vectors_.col(size_++) = u / rest;
    return true;
  }

 private:
  const SparseMatrix& mass_;
  Eigen::MatrixXd vectors_;
  Eigen::Index size_ = 0;
};

/// A Krylov sequence: each vector is K' or (1 + τ²K')⁻¹ times the one before.
struct Sequence {
  Eigen::Index last;
  bool inverse;
  bool ended = false;
};

void grow(LinearSystem& linear, double tau_squared, std::vector<Sequence> sequences, MassBasis& basis) {
  Vector next;
  const auto ended = [](const Sequence& s) { return s.ended; };
  while (!basis.is_full() && !std::ranges::all_of(sequences, ended))
    for (Sequence& s : sequences) {
      if (s.ended) continue;
      const Vector last = basis.vectors().col(s.last);
      StepStatus status = StepStatus::done;
      if (s.inverse) {
        status = linear.solve_shifted({1, 0, tau_squared}, last, next).status;
      } else {
        linear.stiffness_times(last, next);
      }
      s.ended = status != StepStatus::done || !basis.append(next);
      s.last = basis.size() - 1;
    }
}

// Vᵀ M A V of an operator A = M⁻¹(…), symmetric.
template <class Product>
Eigen::MatrixXd projected(const MassBasis& basis, const Product& product) {
  Eigen::MatrixXd a(basis.size(), basis.size());
  Vector u;
  for (Eigen::Index j = 0; j < basis.size(); ++j) {
    product(basis.vectors().col(j), u);
    a.col(j) = basis.coefficients(u);
  }
  return (a + a.transpose()) / 2;
}

}  // namespace

MotionSpectrum motion_spectrum(Model& model, const State<Vector>& start, double k0) {
  System& system = model.system();
  const SparseMatrix mass = model.structure(start).matrices.mass;
  Linearization<Vector> linear;
  system.linearize(start.x, start.v, linear);
  MassBasis basis(
      mass, std::min(system.size(), std::clamp(most_numbers / system.size(), least_vectors, most_vectors)));
  MotionSpectrum motion{{}, k0, model.damping()};
  Vector a;
  system.acceleration(start.x, Vector::Zero(system.size()), a);
  motion.at_rest = start.v.isZero(0) && !(basis.norm(a) > still * k0 * basis.norm(start.x));
  if (motion.at_rest) a.setOnes();

  std::vector<Sequence> sequences;
  for (const Vector& u : {a, start.v})
    if (basis.append(u))
      for (const bool inverse : {true, false}) sequences.push_back({basis.size() - 1, inverse});
  grow(*linear, k0 > 0 ? slow_and_fast / k0 : 0, sequences, basis);

  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      projected(basis, [&](const Vector& u, Vector& out) { linear->stiffness_times(u, out); }));
  const Eigen::MatrixXd& u = modes.eigenvectors();
  const Vector accelerations = u.transpose() * basis.coefficients(a);
  const Vector velocities = u.transpose() * basis.coefficients(start.v);
  Vector d = (motion.damping.d0 + motion.damping.alpha * modes.eigenvalues().array()).matrix();
  if (motion.damping.kind == DampingModel::Kind::general) {
    const Eigen::MatrixXd damping =
        projected(basis, [&](const Vector& v, Vector& out) { linear->damping_times(v, out); });
    d = (u.transpose() * damping * u).diagonal();
  }
  for (Eigen::Index i = 0; i < d.size(); ++i)
    motion.modes.push_back({modes.eigenvalues()[i], d[i], accelerations[i], velocities[i]});
  return motion;
}

std::optional<double> slowest_period(const MotionSpectrum& motion) {
  double all = 0, slowest = 0;
  const auto amplitude = [](const MovingMode& m) {
    return m.acceleration * m.acceleration / (m.k * m.k) + m.velocity * m.velocity / m.k;
  };
  const auto returns = [&](const MovingMode& m) { return m.k > nothing_brings_back * motion.k0; };
  for (const MovingMode& mode : motion.modes)
    if (returns(mode)) all += amplitude(mode);
  for (const MovingMode& mode : motion.modes)
    if (returns(mode) && amplitude(mode) > 0 && amplitude(mode) >= carries * all)
      slowest = std::max(slowest, 2 * std::numbers::pi / std::sqrt(mode.k));
  return slowest > 0 ? std::optional(slowest) : std::nullopt;
}

}  // namespace springstab
