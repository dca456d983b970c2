// A chain of masses on a line between two walls: mass i between springs i and i + 1, displaced by x_i [m]
// from rest. Tridiagonal, so that everything about it is solved directly.
//
//     SpringChain chain({1, 2, 1}, {300, 200, 200, 300}, RayleighDamping{.d0 = 0.5});
//     State<Vector> state{Vector::Constant(3, 0.1), Vector::Zero(3)};
//     const auto euler = make_stepper(SymplecticEuler());
//     while (euler->step(chain, 0.01, state) == StepStatus::done && state.x[1] > 0) continue;
#pragma once

#include <optional>
#include <vector>

#include "solvers/linear/block_linear_system.h"
#include "solvers/linear/structural_matrices.h"
#include "solvers/system.h"

namespace springstab {

/// M x'' = -K x - (d0 M + alpha K) v.
class SpringChain final : public LinearSystem {
 public:
  /// n masses [kg] and n + 1 springs [N/m], the first and the last of them to a wall. Throws
  /// std::invalid_argument for other numbers of them, masses that are not positive and negative springs.
  SpringChain(const std::vector<double>& mass, const std::vector<double>& stiffness, RayleighDamping damping);

  const RayleighDamping& damping() const { return damping_; }
  void set_damping(const RayleighDamping& damping);
  /// M and K; the damping is not among them.
  StructuralMatrices matrices() const;

  Eigen::Index size() const override { return mass_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override;
  void stiffness_times(const Vector& u, Vector& out) override;
  void damping_times(const Vector& u, Vector& out) override;
  /// By an LDLᵀ factorization, which is kept while the shift stays the same. It passes over the chain twice
  /// and is reported as one product.
  SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override;
  SolveReport solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) override;
  double kinetic_energy(const Vector& v) override;
  double potential_energy(const Vector& x) override;

 private:
  void stretch(const Vector& u);
  StepStatus factorize(const Shift& shift);

  Vector mass_, inverse_mass_, stiffness_;
  RayleighDamping damping_;
  Vector tension_, sum_;           // of the springs; x + alpha v
  Vector pivot_inverse_, factor_;  // of (m + d d0) M + (d alpha + k) K
  std::optional<Shift> factorized_;
};

}  // namespace springstab
