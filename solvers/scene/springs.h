// Damped Hookean springs as terms of a scene. With d = x_i - x_j, l = |d|, n = d/l:
//     E = ½ k_s (l - l0)²,   f_i = -k_s (l - l0) n,                               (course notes Eqs. 1, 5)
//     -∂f_i/∂x_i = k_s [(1 - l0/l)(I - nnᵀ) + nnᵀ],                               (course notes Eq. 17)
//     f_i = -k_d ((v_i - v_j)·n) n,   -∂f_i/∂v_i = k_d nnᵀ,                       (course notes Eqs. 2, 18)
// and the opposite on j. Two particles in one place leave n undefined: the force is then not a number and the
// step reports that it diverged.
#pragma once

#include <span>

#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/terms.h"

namespace springstab {

/// The elastic part. Particle numbers are a scene's own: free ones first, `free_count` of them.
class Springs final : public ElasticTerm {
 public:
  Springs(std::vector<Spring> springs, int free_count);

  double energy(const ParticleField& x) const override;
  void add_force(const ParticleField& x, double* force) const override;
  void add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const override;
  Couplings couplings() const override;
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

 private:
  std::vector<Spring> springs_;
  int free_count_;
};

/// The damping part, over the springs with k_d > 0.
class AxialDamping final : public DampingTerm {
 public:
  AxialDamping(std::vector<Spring> springs, int free_count);

  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override;
  Couplings couplings() const override;
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override;

 private:
  std::vector<Spring> springs_;
  int free_count_;
};

}  // namespace springstab
