// Tableaus as data: Runge-Kutta, partitioned and Nyström methods of any kind, explicit or implicit, are all
// of the form
//     X_i = x + c_i hv + h² Σ ā_ij f_j,   V_i = v + h Σ â_ij f_j,   f_i = a(X_i, V_i),
//     x⁺ = x + hv + h² Σ b̄_i f_i,         v⁺ = v + h Σ b̂_i f_i.
// A Runge-Kutta tableau (A, b) has ā = A², â = A, b̄ = bA, b̂ = b, c = A1; a partitioned one of (A, b) for x
// and (Â, b̂) for v has ā = AÂ, b̄ = bÂ, c = A1.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace springstab {

struct StageTableau {
  Eigen::MatrixXd position, velocity;                     // ā, â, s x s
  Eigen::VectorXd c, position_weights, velocity_weights;  // c, b̄, b̂
};

/// Square A, and b of as many entries. Throws std::invalid_argument for Σb != 1, with the sum.
StageTableau runge_kutta(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// A pair of such.
StageTableau partitioned(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                         const Eigen::MatrixXd& a_velocity, const Eigen::VectorXd& b_velocity);

/// Throws std::invalid_argument, with the sum, for Σb̂ != 1.
void check_consistent(const StageTableau& tableau);

/// Without the stages that neither the new state nor another stage of use depends on.
StageTableau without_idle_stages(const StageTableau& tableau);

/// Which stages a stage depends on: those before it, itself too, or later ones.
enum class StageKind { explicit_stages, diagonally_implicit, fully_implicit };
StageKind kind_of(const StageTableau& tableau);

/// The order of accuracy for any x'' = a(x, v), 8 at most: the conditions of the trees whose vertices are
/// forces, with children that move the velocity or the position, hold to 1e-9.
int order_of(const StageTableau& tableau);

}  // namespace springstab
