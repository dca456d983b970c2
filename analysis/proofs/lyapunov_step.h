// Steps of small systems that a discrete Lyapunov matrix proves stable: with A the method's transition
// matrix, P and P - AᵀPA positive definite mean that the norm √(wᵀPw) falls at every step. Where D' and K' do
// not commute this proves what no convex part of the region can.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "analysis/method.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

class LyapunovSteps {
 public:
  /// Up to as many unknowns; a trial costs about 40 products of matrices of twice that size.
  static constexpr Eigen::Index unknowns_limit = 100;

  /// Of a structure with positive semidefinite K and D and a diagonal M, without its rigid motions, which are
  /// neutral under every method.
  explicit LyapunovSteps(const StructuralMatrices& s);

  /// Whether a step of h is proved to be stable, in spite of the rounding of A, of P - AᵀPA and of the
  /// Cholesky factorizations. It takes K positive definite but for rigid motions, and a method that has a
  /// magnitude.
  bool proves(const Method& method, double h) const;

  /// The first step proved of those that fall from `h_max`, the true limit, by growing gaps to `least`;
  /// nothing where none is. Unlike a polygon it says nothing of smaller steps.
  std::optional<double> certified(const Method& method, double least, double h_max) const;

 private:
  // K' and D' in the basis of K's eigenvectors, and bounds on what their entries sum up
  Eigen::MatrixXd stiffness_, damping_, stiffness_size_, damping_size_;
  double rounding_ = 0;  // of A's entries, relative to those of the method's step with these bounds
};

}  // namespace springstab
