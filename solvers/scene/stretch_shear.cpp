#include "solvers/scene/stretch_shear.h"

namespace springstab {

StretchShear::StretchShear(std::shared_ptr<const TriangleConditions> triangles,
                           const PerTriangleCondition& stiffness, const RestStretch& rest)
    : triangles_(std::move(triangles)), stiffness_(stiffness), rest_(rest) {}

double StretchShear::energy(const ParticleField& x) const {
  return triangles_->elements().sum(x, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), k = stiffness_, rest = rest_](const CornerVectors<3>& at,
                                                                               int i) SPRINGSTAB_LANE {
      const Deformation d = shapes.deformation(at, i);
      const double c_u = d.l_u - rest.u, c_v = d.l_v - rest.v;
      return shapes.weight[i] *
             (k.stretch_u * c_u * c_u + k.stretch_v * c_v * c_v + k.shear * d.shear * d.shear);
    };
  }) / 2;
}

void StretchShear::add_force(const ParticleField& x, double* force) const {
  triangles_->elements().add_vectors(x, force, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), stiffness = stiffness_, rest = rest_](
               const CornerVectors<3>& at, int i, CornerVectors<3>& out) SPRINGSTAB_LANE {
      const Deformation d = shapes.deformation(at, i);
      const PerTriangleCondition k = stiffness.scaled(-shapes.weight[i]);
      shapes.combine_gradients(
          d, {k.stretch_u * (d.l_u - rest.u), k.stretch_v * (d.l_v - rest.v), k.shear * d.shear}, i, out);
    };
  });
}

// out += scale · K u, and minus the energy's gradient where the force is wanted too.
template <bool with_force>
void StretchShear::add_products(const ParticleField& x, const double* u, double scale, double* out) const {
  triangles_->elements().add_vectors(x, u, out, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), stiffness = stiffness_, rest = rest_, scale](
               const CornerVectors<3>& at, const CornerVectors<3>& direction, int i,
               CornerVectors<3>& product) SPRINGSTAB_LANE {
      const Deformation d = shapes.deformation(at, i);
      const PerTriangleCondition k = stiffness.scaled(scale * shapes.weight[i]);
      const double t_u = k.stretch_u * (1 - rest.u / d.l_u), t_v = k.stretch_v * (1 - rest.v / d.l_v);
      const double swap = k.shear * d.shear;
      const Vec3 u_u = shapes.along_u(direction, i), u_v = shapes.along_v(direction, i);
      double s_u = (k.stretch_u - t_u) * dot(d.n_u, u_u), s_v = (k.stretch_v - t_v) * dot(d.n_v, u_v);
      double s_s = k.shear * (dot(d.w_v, u_u) + dot(d.w_u, u_v));
      if constexpr (with_force) {
        const PerTriangleCondition f = stiffness.scaled(-shapes.weight[i]);
        s_u += f.stretch_u * (d.l_u - rest.u);
        s_v += f.stretch_v * (d.l_v - rest.v);
        s_s += f.shear * d.shear;
      }
      shapes.pull_back(s_u * d.n_u + s_s * d.w_v + t_u * u_u + swap * u_v,
                       s_v * d.n_v + s_s * d.w_u + t_v * u_v + swap * u_u, i, product);
    };
  });
}

void StretchShear::add_stiffness_times(const ParticleField& x, const double* u, double scale,
                                       double* out) const {
  add_products<false>(x, u, scale, out);
}

void StretchShear::add_damped_force(const ParticleField& x, const double* v, double alpha,
                                    double* force) const {
  add_products<true>(x, v, -alpha, force);
}

Couplings StretchShear::couplings() const { return triangles_->elements().couplings(); }

template <StretchShear::Curvature curvature>
void StretchShear::add_blocks(const ParticleField& x, BlockSparseMatrix& matrix) const {
  triangles_->elements().add_blocks(x, places_, matrix, [&](int batch) {
    return [&shapes = triangles_->shapes(batch), stiffness = stiffness_, rest = rest_](
               const CornerVectors<3>& at, int i, CornerBlocks<3>& blocks) SPRINGSTAB_LANE {
      const Deformation d = shapes.deformation(at, i);
      const PerTriangleCondition k = stiffness.scaled(shapes.weight[i]);
      double t_u = k.stretch_u * (1 - rest.u / d.l_u), t_v = k.stretch_v * (1 - rest.v / d.l_v);
      double swap = k.shear * d.shear, lift = 0;
      if constexpr (curvature == Curvature::positive) {
        t_u = t_u < 0 ? 0 : t_u;  // what is not a number stays so
        t_v = t_v < 0 ? 0 : t_v;
        swap /= 2;
        lift = std::abs(swap);
      }
      // t (I - nnᵀ) + k nnᵀ = (k - t) nnᵀ + t I
      const auto h =
          TriangleConditions::gradient_products(d, {k.stretch_u - t_u, k.stretch_v - t_v, k.shear});
      shapes.pull_back({h.uu + isotropic(t_u + lift), h.vv + isotropic(t_v + lift), h.uv + isotropic(swap)},
                       i, blocks);
    };
  });
}

void StretchShear::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  add_blocks<Curvature::exact>(x, stiffness);
}

void StretchShear::add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  add_blocks<Curvature::positive>(x, stiffness);
}

}  // namespace springstab
