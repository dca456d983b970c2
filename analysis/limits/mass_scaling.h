// Selective mass scaling: how little mass, added to which particles, makes a matrix condition hold.
//     minimize Σ_p Δm_p   such that   c (M + ΔM) - N ≻ 0,   Δm_p >= 0,
// ΔM diagonal, Δm_p on each unknown of particle p: a semidefinite program. Its dual,
//     maximize tr Vᵀ(N - c M)V   such that   |V_p|_F <= 1 for the rows V_p of each particle,
// is climbed particle by particle (Burer and Monteiro 2003; Wang and Kolter 2017): with Q = c M - N the best
// V_p is -(Q_pp + τ I)⁻¹ Σ_q Q_pq V_q, and its multiplier τ >= 0 is c Δm_p in the end. Whatever V is, the
// dual's value bounds the least sum from below; what is given is proved by a factorization.
#pragma once

#include <optional>
#include <vector>

#include "solvers/linear/structural_matrices.h"

namespace springstab {

struct MassScaling {
  struct Added {
    long particle;  // number of its unknowns' group
    double mass;    // [kg]
  };
  std::vector<Added> particles;  // those that get some
  double added_mass = 0;         // their sum [kg]
  double least = 0;              // no diagonal ΔM with a smaller sum does, but for rounding [kg]
  bool proved = false;           // that the condition holds

  /// Of each of n unknowns, `width` of them a particle.
  Eigen::VectorXd of_unknowns(Eigen::Index n, int width) const;
};

/// N symmetric, c > 0; `width` unknowns a particle, a divisor of their number. What is found exceeds the
/// condition by 1e-8 of N. Not proved where the matrix is too large to be factorized and not diagonally
/// dominant.
MassScaling scale_masses(const SparseMatrix& mass, const SparseMatrix& n, double c, int width);

}  // namespace springstab
