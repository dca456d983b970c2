#include "solvers/scene/altitude_springs.h"

#include <Eigen/Geometry>

namespace springstab {
namespace {

/// In the letters of the header.
struct AltitudeShape {
  double h;
  Vec3 n, b1, b2, b3;
  double w1, w2, w3;
};

[[gnu::always_inline]] inline AltitudeShape altitude_shape(const CornerVectors<4>& x, int lane) {
  const Vec3 x1 = x.get(1, lane), e2 = x.get(2, lane) - x1, e3 = x.get(3, lane) - x1;
  const Vec3 d = x.get(0, lane) - x1, normal = cross(e2, e3);
  const double per_length = 1 / std::sqrt(dot(normal, normal));
  const Vec3 n = per_length * normal;
  const Vec3 b2 = per_length * cross(e3, n), b3 = per_length * cross(n, e2);
  const double w2 = dot(b2, d), w3 = dot(b3, d);
  return {dot(n, d), n, -(b2 + b3), b2, b3, 1 - w2 - w3, w2, w3};
}

/// factor · ∇h
[[gnu::always_inline]] inline void set(CornerVectors<4>& out, int lane, double factor,
                                       const AltitudeShape& s) {
  const Vec3 f = factor * s.n;
  out.set(0, lane, f);
  out.set(1, lane, -s.w1 * f);
  out.set(2, lane, -s.w2 * f);
  out.set(3, lane, -s.w3 * f);
}

/// r = Σ ρ_c u_c
[[gnu::always_inline]] inline Vec3 relative(const AltitudeShape& s, const CornerVectors<4>& u, int lane) {
  return u.get(0, lane) - (s.w1 * u.get(1, lane) + s.w2 * u.get(2, lane) + s.w3 * u.get(3, lane));
}

}  // namespace

double altitude(const std::array<Eigen::Vector3d, 4>& x) {
  return (x[2] - x[1]).cross(x[3] - x[1]).normalized().dot(x[0] - x[1]);
}

Altitudes::Altitudes(const std::vector<Altitude>& altitudes, int free_count)
    : elements_(altitudes, free_count), rest_(elements_.batches()) {
  for (int slot = 0; slot < batch_size * elements_.batches(); ++slot)
    rest_[slot / batch_size].h[slot % batch_size] = altitudes[std::min(slot, elements_.size() - 1)].rest;
}

void Altitudes::add_gradient_products(const ParticleField& x, double factor, const BlockPlaces<4>& places,
                                      BlockSparseMatrix& matrix) const {
  elements_.add_blocks(x, places, matrix, [&](int) {
    return [factor](const CornerVectors<4>& at, int i, CornerBlocks<4>& blocks) SPRINGSTAB_LANE {
      const AltitudeShape s = altitude_shape(at, i);
      const Mat3 nn = outer(factor * s.n, s.n);
      const double rho[4] = {1, -s.w1, -s.w2, -s.w3};
      for (int c = 0; c < 4; ++c)
        for (int d = c; d < 4; ++d) blocks.set(c, d, i, rho[c] * rho[d] * nn);
    };
  });
}

AltitudeSprings::AltitudeSprings(std::shared_ptr<const Altitudes> altitudes, double stiffness)
    : altitudes_(std::move(altitudes)), stiffness_(stiffness) {}

double AltitudeSprings::energy(const ParticleField& x) const {
  const double squares = altitudes_->elements().sum(x, [&](int batch) {
    return [&rest = altitudes_->rest(batch)](const CornerVectors<4>& at, int i) SPRINGSTAB_LANE {
      const double stretch = altitude_shape(at, i).h - rest.h[i];
      return stretch * stretch;
    };
  });
  return stiffness_ * squares / 2;
}

void AltitudeSprings::add_force(const ParticleField& x, double* force) const {
  altitudes_->elements().add_vectors(x, force, [&](int batch) {
    return [&rest = altitudes_->rest(batch), stiffness = stiffness_](const CornerVectors<4>& at, int i,
                                                                     CornerVectors<4>& out) SPRINGSTAB_LANE {
      const AltitudeShape s = altitude_shape(at, i);
      set(out, i, -stiffness * (s.h - rest.h[i]), s);
    };
  });
}

void AltitudeSprings::add_stiffness_times(const ParticleField& x, const double* u, double scale,
                                          double* out) const {
  altitudes_->elements().add_vectors(x, u, out, [&](int batch) {
    return [&rest = altitudes_->rest(batch), stiffness = scale * stiffness_](
               const CornerVectors<4>& at, const CornerVectors<4>& direction, int i,
               CornerVectors<4>& product) SPRINGSTAB_LANE {
      const AltitudeShape s = altitude_shape(at, i);
      const double stretched = stiffness * (s.h - rest.h[i]);
      const Vec3 r = relative(s, direction, i);
      const double a1 = dot(s.n, direction.get(1, i)), a2 = dot(s.n, direction.get(2, i)),
                   a3 = dot(s.n, direction.get(3, i));
      const Vec3 turn = -(a1 * s.b1 + a2 * s.b2 + a3 * s.b3);  // δn
      // k n (n·r) + k (h - h0) δn on r, and -k (h - h0) n (b_i·(r - h δn)) on x_i
      const Vec3 on_r = stiffness * dot(s.n, r) * s.n + stretched * turn, q = r - s.h * turn;
      product.set(0, i, on_r);
      product.set(1, i, -s.w1 * on_r - stretched * dot(s.b1, q) * s.n);
      product.set(2, i, -s.w2 * on_r - stretched * dot(s.b2, q) * s.n);
      product.set(3, i, -s.w3 * on_r - stretched * dot(s.b3, q) * s.n);
    };
  });
}

void AltitudeSprings::add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  altitudes_->elements().add_blocks(x, places_, stiffness, [&](int batch) {
    return [&rest = altitudes_->rest(batch), k = stiffness_](const CornerVectors<4>& at, int i,
                                                             CornerBlocks<4>& blocks) SPRINGSTAB_LANE {
      const AltitudeShape s = altitude_shape(at, i);
      const double stretched = k * (s.h - rest.h[i]);
      const Mat3 nn = outer(s.n, s.n);
      const double rho[4] = {1, -s.w1, -s.w2, -s.w3};
      const Vec3 beta[4] = {{0, 0, 0}, s.b1, s.b2, s.b3};
      for (int c = 0; c < 4; ++c)
        for (int d = c; d < 4; ++d)
          blocks.set(
              c, d, i,
              (k * rho[c] * rho[d] - stretched * s.h * dot(beta[c], beta[d])) * nn +
                  -(outer((stretched * rho[c]) * beta[d], s.n) + outer(s.n, (stretched * rho[d]) * beta[c])));
    };
  });
}

void AltitudeSprings::add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const {
  altitudes_->add_gradient_products(x, stiffness_, places_, stiffness);
}

AltitudeDamping::AltitudeDamping(std::shared_ptr<const Altitudes> altitudes, double damping)
    : altitudes_(std::move(altitudes)), damping_(damping) {}

void AltitudeDamping::add_force(const ParticleField& x, const ParticleField& v, double* force) const {
  altitudes_->elements().add_vectors(x, v, force, [&](int) {
    return [damping = damping_](const CornerVectors<4>& at, const CornerVectors<4>& velocity, int i,
                                CornerVectors<4>& out) SPRINGSTAB_LANE {
      const AltitudeShape s = altitude_shape(at, i);
      set(out, i, -damping * dot(s.n, relative(s, velocity, i)), s);
    };
  });
}

void AltitudeDamping::add_damping(const ParticleField& x, BlockSparseMatrix& damping) const {
  altitudes_->add_gradient_products(x, damping_, places_, damping);
}

}  // namespace springstab
