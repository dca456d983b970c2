#include "analysis/proofs/step_magnitude.h"

#include "solvers/linear/dense_solvers.h"

namespace springstab {

// With H = m + dD + kK = LLᵀ the computed solution solves (H + E) y = r, |E| at most some 3n roundings of
// |L||Lᵀ|, of which an entry is at most √(h_ii h_jj): so y is off by |H⁻¹||E||H⁻¹||r|. With what H is summed
// up from in E as well, G = |E| + |H| bounds more than the solution itself: |H⁻¹| <= |H⁻¹||H||H⁻¹|.
SolveReport MagnitudeSystem::solve_shifted(const Shift& shift, const Magnitude& rhs, Magnitude& out) const {
  constexpr double inexact = 1e-6;  // of the inverse, relative to its norm
  const Eigen::Index n = of.stiffness.rows();
  sums += 2;
  Eigen::MatrixXd h = shift.damping * of.damping + shift.stiffness * of.stiffness;
  h.diagonal().array() += shift.mass;
  const Eigen::LLT<Eigen::MatrixXd> factor(h);
  if (factor.info() != Eigen::Success) return {.status = StepStatus::not_positive_definite};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n), inverse = factor.solve(one);
  if (!((h * inverse - one).norm() < inexact / 2)) return {.status = StepStatus::not_converged};
  const Eigen::MatrixXd size = inverse.cwiseAbs().array() + inexact * inverse.norm();
  const Eigen::VectorXd root = h.diagonal().cwiseSqrt();
  Eigen::MatrixXd terms = std::abs(shift.damping) * of.damping_size +
                          std::abs(shift.stiffness) * of.stiffness_size + root * root.transpose();
  terms.diagonal().array() += std::abs(shift.mass);
  out.entries = size * (terms * (size * rhs.entries));
  return {};
}

}  // namespace springstab
