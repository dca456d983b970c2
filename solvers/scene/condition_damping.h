// Baraff's and Witkin's damping as terms of a scene: each condition C of the cloth resists its own rate of
// change,
//     f = -k_d ∇C Ċ,  Ċ = ∇Cᵀ v,   so the damping matrix is Σ k_d ∇C∇Cᵀ,
// which leaves rigid motion alone. The change of ∇C with x is neglected in the linearization, as everywhere.
// The conditions and their gradients are the energies' own (triangle_conditions.h, hinge_angles.h).
#pragma once

#include "solvers/scene/hinge_angles.h"
#include "solvers/scene/triangle_conditions.h"

namespace springstab {

/// Of stretch and shear. The area scaling is that of the triangles: k_d = κ_d A or κ_d A².
class StretchShearDamping final : public DampingTerm {
 public:
  /// damping: κ_d [N·s/m], or [N·s/m³] with the original scaling, not negative.
  StretchShearDamping(std::shared_ptr<const TriangleConditions> triangles,
                      const PerTriangleCondition& damping);

  std::string_view name() const override { return "triangles that damp stretch and shear"; }
  int size() const override { return triangles_->elements().size(); }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override;
  Couplings couplings() const override;
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override;

  /// Looks up once where the blocks are in a matrix that outlives this term; other matrices are filled
  /// slowly.
  void bind(const SharedPattern& pattern) override { places_.bind(triangles_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  std::shared_ptr<const TriangleConditions> triangles_;
  PerTriangleCondition damping_;
  BlockPlaces<3> places_;
};

/// Of the angles between triangles.
class BendingDamping final : public DampingTerm {
 public:
  /// damping: k_d [N·m·s], not negative.
  BendingDamping(std::shared_ptr<const HingeAngles> hinges, double damping);

  std::string_view name() const override { return "hinges that damp bending"; }
  int size() const override { return hinges_->elements().size(); }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override;
  Couplings couplings() const override;
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override;

  /// Looks up once where the blocks are in a matrix that outlives this term; other matrices are filled
  /// slowly.
  void bind(const SharedPattern& pattern) override { places_.bind(hinges_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  std::shared_ptr<const HingeAngles> hinges_;
  double damping_;  // [N·m·s]
  BlockPlaces<4> places_;
};

}  // namespace springstab
