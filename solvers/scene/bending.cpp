#include "solvers/scene/bending.h"

namespace springstab {
namespace {

/// The second derivative of one side's θ in (r, δe), times a factor: [[rr, re], [reᵀ, ½ η rr]].
struct SideHessian {
  Mat3 rr, re;
};

[[gnu::always_inline]] inline SideHessian hessian(const HingeSide& side, const Vec3& g, double factor) {
  const Vec3 q = -factor * side.p;
  const Mat3 qc = outer(q, side.c);
  return {qc + transposed(qc), outer(g, q)};
}

}  // namespace

Bending::Bending(std::shared_ptr<const HingeAngles> hinges, double stiffness)
    : hinges_(std::move(hinges)), stiffness_(stiffness) {}

double Bending::energy(const ParticleField& x) const {
  const double squares = hinges_->elements().sum(x, [&](int batch) {
    return [&rest = hinges_->rest_angles(batch)](const CornerVectors<4>& at, int i) SPRINGSTAB_LANE {
      const double angle = rest.turned(hinge_shape(at, i), i);
      return angle * angle;
    };
  });
  return stiffness_ * squares / 2;
}

void Bending::add_force(const ParticleField& x, double* force) const {
  hinges_->elements().add_vectors(x, force, [&](int batch) {
    return [&rest = hinges_->rest_angles(batch), stiffness = stiffness_](
               const CornerVectors<4>& at, int i, CornerVectors<4>& out) SPRINGSTAB_LANE {
      const HingeShape h = hinge_shape(at, i);
      set(out, i, -stiffness * rest.turned(h, i), gradient(h));
    };
  });
}

// out += scale · K u, and minus the energy's gradient where the force is wanted too.
template <bool with_force>
void Bending::add_products(const ParticleField& x, const double* u, double scale, double* out) const {
  hinges_->elements().add_vectors(x, u, out, [&](int batch) {
    return [&rest = hinges_->rest_angles(batch), force = -stiffness_, stiffness = scale * stiffness_](
               const CornerVectors<4>& at, const CornerVectors<4>& direction, int i,
               CornerVectors<4>& product) SPRINGSTAB_LANE {
      const HingeShape h = hinge_shape(at, i);
      const HingeGradient g = gradient(h);
      const Vec3 u0 = direction.get(0, i), u1 = direction.get(1, i), de = u1 - u0;
      const double angle = rest.turned(h, i), turned = stiffness * angle;
      const double along = stiffness * dot(g, direction, i) + (with_force ? force * angle : 0);
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
    };
  });
}

void Bending::add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const {
  add_products<false>(x, u, scale, out);
}

void Bending::add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const {
  add_products<true>(x, v, -alpha, force);
}

Couplings Bending::couplings() const { return hinges_->elements().couplings(); }

void Bending::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  hinges_->elements().add_blocks(x, places_, stiffness, [&](int batch) {
    return [&rest = hinges_->rest_angles(batch), k = stiffness_](const CornerVectors<4>& at, int i,
                                                                 CornerBlocks<4>& blocks) SPRINGSTAB_LANE {
      const HingeShape shape = hinge_shape(at, i);
      const HingeGradient g = gradient(shape);
      const double turned = k * rest.turned(shape, i);
      const SideHessian a = hessian(shape.a, shape.g, turned), b_ = hessian(shape.b, shape.g, turned);
      // In r = Σ ρ_c δx_c and δe = Σ ε_c δx_c, x1 has ρ = -s, ε = 1 and the apex ρ = 1, ε = 0. What is left
      // follows from translation, which changes no force: the blocks of a row add up to zero.
      const double s = shape.a.s, t = shape.b.s;
      const Vec3 k1 = k * g.x1, k2 = k * g.x2, k3 = k * g.x3;
      const Mat3 k22 = outer(k2, g.x2) + a.rr, k33 = outer(k3, g.x3) + b_.rr, k23 = outer(k2, g.x3);
      const Mat3 k12 = outer(k1, g.x2) + transposed(a.re) + (-s) * a.rr;
      const Mat3 k13 = outer(k1, g.x3) + transposed(b_.re) + (-t) * b_.rr;
      const Mat3 re = (-s) * a.re + (-t) * b_.re;
      const Mat3 k11 = outer(k1, g.x1) + (s * s + shape.a.eta / 2) * a.rr +
                       (t * t + shape.b.eta / 2) * b_.rr + (re + transposed(re));
      const Mat3 k02 = -(k12 + k22 + transposed(k23)), k03 = -(k13 + k23 + k33);
      const Mat3 k01 = -(k11 + transposed(k12) + transposed(k13));
      blocks.set(0, 0, i, -(k01 + k02 + k03));
      blocks.set(0, 1, i, k01);
      blocks.set(0, 2, i, k02);
      blocks.set(0, 3, i, k03);
      blocks.set(1, 1, i, k11);
      blocks.set(1, 2, i, k12);
      blocks.set(1, 3, i, k13);
      blocks.set(2, 2, i, k22);
      blocks.set(2, 3, i, k23);
      blocks.set(3, 3, i, k33);
    };
  });
}

void Bending::add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  hinges_->add_gradient_products(x, stiffness_, places_, stiffness);
}

}  // namespace springstab
