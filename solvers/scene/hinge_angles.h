// The angle at which two triangles of a cloth meet, its gradient and its second derivative: what the energy
// of bending.h and the damping of condition_damping.h have in common.
//
// A hinge joins the triangles (x0, x1, x2) and (x0, x1, x3) at their edge e = x1 - x0, l = |e|; how its faces
// are wound does not matter. With the normals n_a = e × (x2 - x0) and n_b = (x3 - x0) × e, equal in direction
// when flat,
//     θ = atan2(-l n_a·(x3 - x0), n_a·n_b)   in [-π, π], 0 flat, positive where x3 lies below the plane of
//     n_a.
// Triangle a has its apex at the height h = |n_a|/l over the point x0 + s e of the edge's line, where
// s = (x2 - x0)·e/l²; let w = x2 - x0 - s e be that height as a vector, r = δx2 - (1 - s) δx0 - s δx1 how far
// the apex moves with respect to that point and δe = δx1 - δx0. From the rotation of the normal,
//     δθ = p·r + (the same for triangle b),     p = -n_a l/|n_a|²,   |p| = 1/h.
// Differentiating once more (δs = e·r/l² + w·δe/l², and p turns with its triangle) leaves, with
// c = w/h², g = e/l², η = h²/l², for two displacements δ and δ'
//     δ'δθ = -[ (p·r')(c·r) + (p·δe')(g·r + ½ η c·δe) + the same with δ and δ' exchanged ] + (triangle b).
// (Each triangle alone also has the antisymmetric ½ [(m·δe')(n·δe) - (n·δe')(m·δe)]/l², m = w/h, n =
// n_a/|n_a|: a rotation of the plane across the edge, which the two triangles have with opposite signs.)
// There is no coupling of x2 with x3 in it. Checked against differences in tests/test_cloth_energies.cpp.
//
// At ±π, where the triangles lie on each other, the angle jumps but cos and sin do not; the gradient and the
// second derivative are smooth there. A triangle pressed towards a line (h -> 0) has a gradient that grows
// like 1/h; at h = 0 or l = 0 the angle is 0/0: forces are not a number and the step reports that it
// diverged.
#pragma once

#include <vector>

#include "solvers/scene/elements.h"

namespace springstab {

/// Two triangles that share the edge of the particles 0 and 1, with the particles 2 and 3 opposite to it, and
/// the angle θ at which they are at rest: 0 for a flat cloth.
struct Hinge {
  std::array<int, 4> particles;
  double rest_angle = 0;
};

/// One of the two triangles, in the letters above.
struct HingeSide {
  Vec3 p, c;  // [1/m]
  double s, eta;

  /// The vectors r and δe for displacements of x0, x1 and the apex.
  [[gnu::always_inline]] Vec3 relative(const Vec3& u0, const Vec3& u1, const Vec3& apex) const {
    return apex - (1 - s) * u0 - s * u1;
  }
};

struct HingeShape {
  HingeSide a, b;
  Vec3 g;           // [1/m]
  double sin, cos;  // of θ, times one positive factor
};

[[gnu::always_inline]] inline HingeShape hinge_shape(const CornerVectors<4>& x, int lane) {
  const Vec3 x0 = x.get(0, lane), e = x.get(1, lane) - x0, d2 = x.get(2, lane) - x0, d3 = x.get(3, lane) - x0;
  const Vec3 n_a = cross(e, d2), n_b = cross(d3, e);
  const double l2 = dot(e, e), l = std::sqrt(l2), per_l2 = 1 / l2;
  const auto side = [&](const Vec3& n, const Vec3& d) -> HingeSide {
    const double n2 = dot(n, n), per_n2 = 1 / n2, s = dot(d, e) * per_l2;
    return {(-l * per_n2) * n, (l2 * per_n2) * (d - s * e), s, n2 * per_l2 * per_l2};
  };
  return {side(n_a, d2), side(n_b, d3), per_l2 * e, -l * dot(n_a, d3), dot(n_a, n_b)};
}

/// ∂θ/∂x of one hinge.
struct HingeGradient {
  Vec3 x0, x1, x2, x3;
};

[[gnu::always_inline]] inline HingeGradient gradient(const HingeShape& h) {
  return {-((1 - h.a.s) * h.a.p + (1 - h.b.s) * h.b.p), -(h.a.s * h.a.p + h.b.s * h.b.p), h.a.p, h.b.p};
}

[[gnu::always_inline]] inline void set(CornerVectors<4>& out, int lane, double factor,
                                       const HingeGradient& g) {
  out.set(0, lane, factor * g.x0);
  out.set(1, lane, factor * g.x1);
  out.set(2, lane, factor * g.x2);
  out.set(3, lane, factor * g.x3);
}

[[gnu::always_inline]] inline double dot(const HingeGradient& g, const CornerVectors<4>& u, int lane) {
  return dot(g.x0, u.get(0, lane)) + dot(g.x1, u.get(1, lane)) + dot(g.x2, u.get(2, lane)) +
         dot(g.x3, u.get(3, lane));
}

/// The hinges of a cloth, shared by its energy and its damping.
class HingeAngles {
 public:
  /// Particle numbers are a scene's own: free ones first, `free_count` of them.
  HingeAngles(const std::vector<Hinge>& hinges, int free_count);

  /// The angles of a batch of hinges at rest.
  struct alignas(64) RestAngles {
    double cos[batch_size], sin[batch_size];

    /// How far a hinge is turned from rest, in [-π, π].
    [[gnu::always_inline]] double turned(const HingeShape& h, int lane) const {
      return arctangent(h.sin * cos[lane] - h.cos * sin[lane], h.cos * cos[lane] + h.sin * sin[lane]);
    }
  };

  const Elements<4>& elements() const { return elements_; }
  const RestAngles& rest_angles(int batch) const { return rest_angles_[batch]; }

  /// matrix += factor · Σ ∇θ∇θᵀ: positive semidefinite for factor >= 0.
  void add_gradient_products(const ParticleField& x, double factor, const BlockPlaces<4>& places,
                             BlockSparseMatrix& matrix) const;

 private:
  Elements<4> elements_;
  std::vector<RestAngles> rest_angles_;
};

}  // namespace springstab
