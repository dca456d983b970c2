#include "solvers/scene/bending.h"

namespace springstab {
namespace {

/// The second derivative of one side's θ in (r, δe), times a factor: [[rr, re], [reᵀ, ee]].
struct SideHessian {
  Mat3 rr, re, ee;
};

[[gnu::always_inline]] inline SideHessian hessian(const HingeSide& side, const Vec3& g, double factor) {
  const Vec3 q = -factor * side.p;
  const Mat3 qc = outer(q, side.c), rr = qc + transposed(qc);
  return {rr, outer(g, q), (side.eta / 2) * rr};
}

// With r = Σ ρ_c δx_c and δe = Σ ε_c δx_c over the corners (x0, x1, apex):
// ρ = (s - 1, -s, 1), ε = (-1, 1, 0).
[[gnu::always_inline]] inline Mat3 edge_block(const SideHessian& h, double rho_c, double epsilon_c,
                                              double rho_d, double epsilon_d) {
  return (rho_c * rho_d) * h.rr + (rho_c * epsilon_d) * h.re + (epsilon_c * rho_d) * transposed(h.re) +
         (epsilon_c * epsilon_d) * h.ee;
}

[[gnu::always_inline]] inline Mat3 apex_block(const SideHessian& h, double rho_c, double epsilon_c) {
  return rho_c * h.rr + epsilon_c * transposed(h.re);
}

}  // namespace

Bending::Bending(std::shared_ptr<const HingeAngles> hinges, double stiffness)
    : hinges_(std::move(hinges)), stiffness_(stiffness) {}

double Bending::energy(const ParticleField& x) const {
  const Elements<4>& elements = hinges_->elements();
  CornerVectors<4> at;
  double squared[batch_size];
  double sum = 0;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& rest = hinges_->rest_angles(b);
    elements.gather(x, b, at);
    for (int i = 0; i < batch_size; ++i) {
      const double angle = rest.turned(hinge_shape(at, i), i);
      squared[i] = angle * angle;
    }
    for (std::size_t i = 0; i < elements.in_batch(b).size(); ++i) sum += squared[i];
  }
  return stiffness_ * sum / 2;
}

void Bending::add_force(const ParticleField& x, double* force) const {
  const Elements<4>& elements = hinges_->elements();
  const double stiffness = stiffness_;
  CornerVectors<4> at, out;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& rest = hinges_->rest_angles(b);
    elements.gather(x, b, at);
    for (int i = 0; i < batch_size; ++i) {
      const HingeShape h = hinge_shape(at, i);
      set(out, i, -stiffness * rest.turned(h, i), gradient(h));
    }
    elements.scatter(out, b, force);
  }
}

void Bending::add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const {
  const Elements<4>& elements = hinges_->elements();
  const double stiffness = scale * stiffness_;
  CornerVectors<4> at, direction, product;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& rest = hinges_->rest_angles(b);
    elements.gather(x, b, at);
    elements.gather_free(u, b, direction);
    for (int i = 0; i < batch_size; ++i) {
      const HingeShape h = hinge_shape(at, i);
      const HingeGradient g = gradient(h);
      const Vec3 u0 = direction.get(0, i), u1 = direction.get(1, i), de = u1 - u0;
      const double along = stiffness * dot(g, direction, i), turned = stiffness * rest.turned(h, i);
      Vec3 f0 = along * g.x0, f1 = along * g.x1;
      // k Δ ∇∇θ: with f_r and f_e the coefficients of r' and δe'
      const auto side = [&](const HingeSide& t, const Vec3& apex) {
        const Vec3 r = t.relative(u0, u1, apex);
        const double p_r = dot(t.p, r), p_e = dot(t.p, de), c_r = dot(t.c, r), c_e = dot(t.c, de);
        const Vec3 f_r = -turned * (c_r * t.p + p_r * t.c + p_e * h.g);
        const Vec3 f_e = -turned * ((dot(h.g, r) + t.eta / 2 * c_e) * t.p + (t.eta / 2 * p_e) * t.c);
        f0 = f0 - (1 - t.s) * f_r - f_e;
        f1 = f1 - t.s * f_r + f_e;
        return f_r;
      };
      product.set(2, i, along * g.x2 + side(h.a, direction.get(2, i)));
      product.set(3, i, along * g.x3 + side(h.b, direction.get(3, i)));
      product.set(0, i, f0);
      product.set(1, i, f1);
    }
    elements.scatter(product, b, out);
  }
}

Couplings Bending::couplings() const { return hinges_->elements().couplings(); }

void Bending::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  const Elements<4>& elements = hinges_->elements();
  const double k = stiffness_;
  CornerVectors<4> at;
  CornerBlocks<4> blocks;
  for (int b = 0; b < elements.batches(); ++b) {
    const auto& rest = hinges_->rest_angles(b);
    elements.gather(x, b, at);
    for (int i = 0; i < batch_size; ++i) {
      const HingeShape shape = hinge_shape(at, i);
      const HingeGradient g = gradient(shape);
      const double turned = k * rest.turned(shape, i);
      const SideHessian a = hessian(shape.a, shape.g, turned), b_ = hessian(shape.b, shape.g, turned);
      const double s = shape.a.s, t = shape.b.s;
      const Vec3 k0 = k * g.x0, k1 = k * g.x1, k2 = k * g.x2, k3 = k * g.x3;
      blocks.set(
          0, 0, i,
          outer(k0, g.x0) + edge_block(a, s - 1, -1, s - 1, -1) + edge_block(b_, t - 1, -1, t - 1, -1));
      blocks.set(0, 1, i,
                 outer(k0, g.x1) + edge_block(a, s - 1, -1, -s, 1) + edge_block(b_, t - 1, -1, -t, 1));
      blocks.set(1, 1, i, outer(k1, g.x1) + edge_block(a, -s, 1, -s, 1) + edge_block(b_, -t, 1, -t, 1));
      blocks.set(0, 2, i, outer(k0, g.x2) + apex_block(a, s - 1, -1));
      blocks.set(1, 2, i, outer(k1, g.x2) + apex_block(a, -s, 1));
      blocks.set(0, 3, i, outer(k0, g.x3) + apex_block(b_, t - 1, -1));
      blocks.set(1, 3, i, outer(k1, g.x3) + apex_block(b_, -t, 1));
      blocks.set(2, 2, i, outer(k2, g.x2) + a.rr);
      blocks.set(3, 3, i, outer(k3, g.x3) + b_.rr);
      blocks.set(2, 3, i, outer(k2, g.x3));
    }
    places_.add(elements, b, blocks, stiffness);
  }
}

void Bending::add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  hinges_->add_gradient_products(x, stiffness_, places_, stiffness);
}

}  // namespace springstab
