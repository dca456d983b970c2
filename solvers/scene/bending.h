// The bending energy of a cloth as a term of a scene: for each pair of triangles at an edge, with the angle θ
// of hinge_angles.h and θ0 that angle at rest,
//     E = ½ k Δ²,   Δ = θ - θ0 in [-π, π],   f = -k Δ ∇θ,   K = k ∇θ∇θᵀ + k Δ ∇∇θ,   k in N·m.
// The energy is continuous; its force jumps where Δ passes ±π, for a flat cloth where the triangles pass
// through each other. k is not weighted with the lengths of the hinge, so a sheet's stiffness depends on its
// triangles.
#pragma once

#include <memory>

#include "solvers/scene/hinge_angles.h"

namespace springstab {

class Bending final : public ElasticTerm {
 public:
  /// stiffness: k [N·m], not negative.
  Bending(std::shared_ptr<const HingeAngles> hinges, double stiffness);

  std::string_view name() const override { return "hinges that resist bending"; }
  int size() const override { return hinges_->elements().size(); }
  double energy(const ParticleField& x) const override;
  void add_force(const ParticleField& x, double* force) const override;
  void add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const override;
  void add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const override;
  Couplings couplings() const override;
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

  /// stiffness += the Gauss-Newton part k ∇θ∇θᵀ, positive semidefinite as a sum of squares; it is K where Δ =
  /// 0.
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

  /// Looks up once where the blocks are in a matrix that outlives this term; other matrices are filled
  /// slowly.
  void bind(const SharedPattern& pattern) override { places_.bind(hinges_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  template <bool with_force>
  void add_products(const ParticleField& x, const double* u, double scale, double* out) const;

  std::shared_ptr<const HingeAngles> hinges_;
  double stiffness_;  // [N·m]
  BlockPlaces<4> places_;
};

}  // namespace springstab
