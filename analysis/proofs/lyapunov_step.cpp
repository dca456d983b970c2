#include "analysis/proofs/lyapunov_step.h"

#include <cmath>

#include "analysis/constants.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/transition_operator.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"

namespace springstab {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr double rigid_eigenvalue = 1e-12;  // of K' + D', each of unit size

// One step of length 1 in the unit of time h.
Matrix transition_matrix(const Matrix& stiffness, const Matrix& damping, const Method& method) {
  StructuralMatrices s;
  s.stiffness = stiffness.sparseView(0.0, 0.0);
  s.damping = damping.sparseView(0.0, 0.0);
  s.mass = Matrix::Identity(stiffness.rows(), stiffness.rows()).sparseView();
  MatrixSystem system(std::move(s));
  return as_dense(transition_operator(system, method, 1));
}

// P = I + AᵀPA by doubling: the sum of (A^i)ᵀA^i up to twice as high a power each time. Not finite where A is
// not stable.
Matrix lyapunov_matrix(Matrix power) {
  Matrix p = Matrix::Identity(power.rows(), power.rows());
  for (int i = 0; i < 60 && p.allFinite(); ++i) {
    const Matrix more = power.transpose() * p * power;
    p += more;
    if (more.norm() <= 1e-6 * p.norm()) break;
    power = (power * power).eval();
  }
  return (p + p.transpose()) / 2;
}

// Whether a symmetric matrix that is known up to `error`, row sums of bounds on its entries' errors, is
// positive definite: see DefinitenessProof.
bool is_definite(Matrix a, const Eigen::VectorXd& error) {
  const auto n = static_cast<double>(a.rows());
  const double factorization = 1.01 * unit_roundoff * (n * (n + 1) / 2 + 2 * n);
  if (!a.allFinite() || !(a.diagonal().minCoeff() > 0)) return false;
  a.diagonal() -= (error + factorization * a.diagonal()).eval();
  return Eigen::LLT<Matrix>(a).info() == Eigen::Success;
}

}  // namespace

// K' and D' are projected twice: off the rigid motions, then into K's eigenvectors, in which soft motions
// keep their accuracy.
LyapunovSteps::LyapunovSteps(const StructuralMatrices& s) {
  if (s.size() > unknowns_limit || !is_diagonal(s.mass) || !s.has_damping()) return;
  const Matrix k = symmetric_part(as_dense(scaled_stiffness(s)));
  const Matrix d = symmetric_part(as_dense(mass_scaled(s.damping, s.mass)));
  const Eigen::SelfAdjointEigenSolver<Matrix> sum(Matrix(k / k.norm() + d / d.norm()));
  const Eigen::Index moving = (sum.eigenvalues().array() > rigid_eigenvalue).count();
  Matrix basis = sum.eigenvectors().rightCols(moving);
  const Eigen::SelfAdjointEigenSolver<Matrix> modes(Matrix(basis.transpose() * k * basis));
  if (sum.info() != Eigen::Success || modes.info() != Eigen::Success) return;
  basis *= modes.eigenvectors();
  const Matrix size = basis.cwiseAbs();
  stiffness_ = symmetric_part(basis.transpose() * k * basis);
  damping_ = symmetric_part(basis.transpose() * d * basis);
  stiffness_size_ = size.transpose() * k.cwiseAbs() * size;
  damping_size_ = size.transpose() * d.cwiseAbs() * size;
  // An entry is a sum over paths of at most 16 sums of n terms, or of as many as the magnitude allows for (a
  // solve counts as two); forming and projecting K' adds 2n to each.
  rounding_ = 16 * (3 * static_cast<double>(s.size()) + 16) * unit_roundoff;
}

bool LyapunovSteps::proves(const Method& method, double h) const {
  const Eigen::Index n = stiffness_.rows();
  if (!method.has_magnitude()) return false;
  if (n == 0 || !(stiffness_.diagonal().minCoeff() > 0)) return false;
  // In units of √k and of h the energy of each mode is ‖w‖², and A is not far from normal.
  const Eigen::Index size = method.size() * n;
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(size);
  scale.head(n) = h * stiffness_.diagonal().cwiseSqrt();
  const auto scaled = [&](const Matrix& a) -> Matrix {
    return scale.asDiagonal() * a * scale.cwiseInverse().asDiagonal();
  };
  const Matrix a = scaled(transition_matrix(h * h * stiffness_, h * damping_, method));
  const std::optional<Matrix> magnitude =
      method.magnitude({h * h * stiffness_, h * damping_, h * h * stiffness_size_, h * damping_size_});
  if (!magnitude) return false;
  const Matrix b = rounding_ * scaled(*magnitude);  // bounds the rounding of a, entry by entry
  const Matrix p = lyapunov_matrix(a);
  if (!is_definite(p, Eigen::VectorXd::Zero(size))) return false;

  const Matrix a_size = a.cwiseAbs(), p_size = p.cwiseAbs();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(size), a_sum = a_size * ones, b_sum = b * ones;
  const double product = (4 * static_cast<double>(size) + 4) * unit_roundoff;
  const Eigen::VectorXd error = 1.01 * (a_size.transpose() * (p_size * (b_sum + product * a_sum)) +
                                        product * p_size * ones + b.transpose() * (p_size * (a_sum + b_sum)));
  return is_definite(symmetric_part(p - a.transpose() * p * a), error);
}

std::optional<double> LyapunovSteps::certified(const Method& method, double least, double h_max) const {
  for (double gap = 1e-6; gap < 1; gap = std::min(4 * gap, (1 + gap) / 2)) {
    const double h = h_max * (1 - gap);
    if (h <= least || gap > 0.99) break;
    if (proves(method, h)) return h;
  }
  return std::nullopt;
}

}  // namespace springstab
