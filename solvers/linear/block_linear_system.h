// The linear system of a net of particles at one state: lumped masses, a block-sparse stiffness matrix,
// Rayleigh damping, and a damping matrix only where the net has damping of its own.
#pragma once

#include <optional>
#include <vector>

#include "solvers/linear/block_cholesky.h"
#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/linear/block_ssor.h"
#include "solvers/linear/conjugate_gradient.h"
#include "solvers/linear/rayleigh_damping.h"
#include "solvers/system.h"

namespace springstab {

class Wavefront;

/// M x'' = -K x - (d0 M + alpha K + C) v for particles with three unknowns each. With Rayleigh damping alone
/// an acceleration is one block product, K (x + alpha v). Solves by preconditioned conjugate gradients or by
/// a Cholesky factorization, made anew at each solve.
class BlockLinearSystem final : public LinearSystem {
 public:
  /// mass: one per particle [kg]. K and C [N/m, N·s/m] start at zero and are filled through stiffness() and
  /// own_damping(); pass no pattern for C when there is none.
  BlockLinearSystem(std::vector<double> mass, RayleighDamping damping, SharedPattern stiffness,
                    SharedPattern own_damping = nullptr);

  BlockSparseMatrix& stiffness() { return stiffness_; }
  const BlockSparseMatrix& stiffness() const { return stiffness_; }
  BlockSparseMatrix* own_damping() { return own_damping_ ? &*own_damping_ : nullptr; }
  const std::vector<double>& mass() const { return mass_; }
  const std::vector<double>& inverse_mass() const { return inverse_mass_; }
  const RayleighDamping& damping() const { return damping_; }
  void set_damping(const RayleighDamping& damping) { damping_ = damping; }
  SolverOptions solver;

  Eigen::Index size() const override { return 3 * static_cast<Eigen::Index>(mass_.size()); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override;
  void stiffness_times(const Vector& u, Vector& out) override;
  void damping_times(const Vector& u, Vector& out) override;
  SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override;
  /// By LU factors, made anew at each solve, whatever `solver` says.
  SolveReport solve_coupled(const StageCoupling& coupling, const std::vector<Vector>& rhs,
                            std::vector<Vector>& out) override;
  SolveReport solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) override;
  /// As many as have what they are at in the cache, all of them.
  long steps_at_once(int stages) const override;
  bool take_steps(long steps, StepByRows& step) override;
  double kinetic_energy(const Vector& v) override;
  double potential_energy(const Vector& x) override;

 private:
  // a of row i, from (K (x + alpha v) + C v) of it.
  void set_acceleration(long i, const Eigen::Vector3d& force, const Vector& v, Vector& a) const;
  void take_stage(StepByRows& step, int stage, const IndexRange& rows);
  void place(const StepByRows& step, int stage, const IndexRange& rows);
  double kinetic_energy(const Vector& v, const IndexRange& rows) const;
  Wavefront wavefront() const;
  SolveReport solve_by_cholesky(const Shift& shift, Vector& out);
  SolveReport solve_by_block_jacobi(const Shift& shift, Vector& out);
  SolveReport solve_by_block_ssor(const Shift& shift, Vector& out);
  bool invert_diagonal_blocks(double mass_factor, double stiffness_factor, double damping_factor);

  std::vector<double> mass_, inverse_mass_;
  RayleighDamping damping_;
  BlockSparseMatrix stiffness_;
  std::optional<BlockSparseMatrix> own_damping_;
  ConjugateGradient conjugate_gradient_;
  std::vector<double> inverse_blocks_;  // of the diagonal of H, 9 per particle, for block Jacobi
  BlockSsor ssor_;
  BlockCholesky cholesky_;
  std::vector<double> kinetic_;  // of steps that are taken together
  Vector w_, product_, rhs_, transformed_rhs_, transformed_out_;
};

}  // namespace springstab
