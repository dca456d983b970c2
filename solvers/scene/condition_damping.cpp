#include "solvers/scene/condition_damping.h"

namespace springstab {

StretchShearDamping::StretchShearDamping(std::shared_ptr<const TriangleConditions> triangles,
                                         const PerTriangleCondition& damping)
    : triangles_(std::move(triangles)), damping_(damping) {}

void StretchShearDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  triangles_->elements().add_vectors(x, v, force, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), damping = damping_](
               const CornerVectors<3>& at, const CornerVectors<3>& velocity, int i, CornerVectors<3>& out)
               SPRINGSTAB_LANE {
                 const Deformation d = shapes.deformation(at, i);
                 const Vec3 rate_u = shapes.along_u(velocity, i), rate_v = shapes.along_v(velocity, i);
                 const PerTriangleCondition k = damping.scaled(-shapes.weight[i]);
                 shapes.combine_gradients(d,
                                          {k.stretch_u * dot(d.n_u, rate_u), k.stretch_v * dot(d.n_v, rate_v),
                                           k.shear * (dot(d.w_v, rate_u) + dot(d.w_u, rate_v))},
                                          i, out);
               };
  });
}

Couplings StretchShearDamping::couplings() const { return triangles_->elements().couplings(); }

void StretchShearDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  triangles_->elements().add_blocks(x, places_, damping, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), coefficients = damping_](
               const CornerVectors<3>& at, int i, CornerBlocks<3>& blocks) SPRINGSTAB_LANE {
      const Deformation d = shapes.deformation(at, i);
      const PerTriangleCondition k = coefficients.scaled(shapes.weight[i]);
      shapes.pull_back(TriangleConditions::gradient_products(d, k), i, blocks);
    };
  });
}

BendingDamping::BendingDamping(std::shared_ptr<const HingeAngles> hinges, double damping)
    : hinges_(std::move(hinges)), damping_(damping) {}

void BendingDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  hinges_->elements().add_vectors(x, v, force, [&](int) {
    return [damping = damping_](const CornerVectors<4>& at, const CornerVectors<4>& velocity, int i,
                                CornerVectors<4>& out) SPRINGSTAB_LANE {
      const HingeGradient g = gradient(hinge_shape(at, i));
      set(out, i, -damping * dot(g, velocity, i), g);
    };
  });
}

Couplings BendingDamping::couplings() const { return hinges_->elements().couplings(); }

void BendingDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  hinges_->add_gradient_products(x, damping_, places_, damping);
}

}  // namespace springstab
