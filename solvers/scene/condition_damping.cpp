#include "solvers/scene/condition_damping.h"

namespace springstab {

StretchShearDamping::StretchShearDamping(std::shared_ptr<const TriangleConditions> triangles,
                                         const PerTriangleCondition& damping)
    : triangles_(std::move(triangles)), damping_(damping) {}

void StretchShearDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  const Elements<3>& elements = triangles_->elements();
  const PerTriangleCondition damping = damping_;
  CornerVectors<3> at, velocity, out;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& shapes = triangles_->shapes(b);
    elements.gather(x, b, at);
    elements.gather(v, b, velocity);
    for (int i = 0; i < batch_size; ++i) {
      const Deformation d = shapes.deformation(at, i);
      const Vec3 rate_u = shapes.along_u(velocity, i), rate_v = shapes.along_v(velocity, i);
      const PerTriangleCondition k = damping.scaled(-shapes.weight[i]);
      shapes.combine_gradients(d,
                               {k.stretch_u * dot(d.n_u, rate_u), k.stretch_v * dot(d.n_v, rate_v),
                                k.shear * (dot(d.w_v, rate_u) + dot(d.w_u, rate_v))},
                               i, out);
    }
    elements.scatter(out, b, force);
  }
}

Couplings StretchShearDamping::couplings() const { return triangles_->elements().couplings(); }

void StretchShearDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  const Elements<3>& elements = triangles_->elements();
  const PerTriangleCondition coefficients = damping_;
  CornerVectors<3> at;
  CornerBlocks<3> blocks;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& shapes = triangles_->shapes(b);
    elements.gather(x, b, at);
    for (int i = 0; i < batch_size; ++i) {
      const Deformation d = shapes.deformation(at, i);
      const PerTriangleCondition k = coefficients.scaled(shapes.weight[i]);
      shapes.pull_back(TriangleConditions::gradient_products(d, k), i, blocks);
    }
    places_.add(elements, b, blocks, damping);
  }
}

BendingDamping::BendingDamping(std::shared_ptr<const HingeAngles> hinges, double damping)
    : hinges_(std::move(hinges)), damping_(damping) {}

void BendingDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  const Elements<4>& elements = hinges_->elements();
  const double damping = damping_;
  CornerVectors<4> at, velocity, out;
  for (int b = 0; b < elements.batches(); ++b) {
    elements.gather(x, b, at);
    elements.gather(v, b, velocity);
    for (int i = 0; i < batch_size; ++i) {
      const HingeGradient g = gradient(hinge_shape(at, i));
      set(out, i, -damping * dot(g, velocity, i), g);
    }
    elements.scatter(out, b, force);
  }
}

Couplings BendingDamping::couplings() const { return hinges_->elements().couplings(); }

void BendingDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  hinges_->add_gradient_products(x, damping_, places_, damping);
}

}  // namespace springstab
