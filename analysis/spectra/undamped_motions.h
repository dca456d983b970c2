// Motions that damping leaves alone: eigenvectors of K' that D' sends to nothing but rounding. Each is an
// eigenvector of the damped system too, and the rest of the system is one of fewer unknowns.
#pragma once

#include <Eigen/Core>

namespace springstab {

struct UndampedMotions {
  Eigen::VectorXd stiffness;  // λ, of K'x = λx, D'x = 0
  Eigen::MatrixXd rest;       // n×(n - count), orthonormal: what is orthogonal to all those x
};

/// `stiffness` and `damping` are K' and D', symmetric, n×n. A motion that is not seen as undamped, as where
/// K' has not resolved its eigenvectors, is part of the rest.
UndampedMotions undamped_motions(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& damping);

}  // namespace springstab
