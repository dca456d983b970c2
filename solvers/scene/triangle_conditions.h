// The conditions on a triangle of cloth whose energy and damping are in stretch_shear.h and
// condition_damping.h, their gradients, and what both do with them. From D. Baraff and A. Witkin, "Large
// steps in cloth animation", SIGGRAPH 1998, section 4: the map from the rest coordinates (u, v) [m] of a
// triangle to space is affine, with the columns
//     w_u = Σ a_c x_c,  w_v = Σ b_c x_c,   Σ a_c = Σ b_c = 0,   a_c = ∂φ_c/∂u,  b_c = ∂φ_c/∂v,
// where φ_c is the linear function that is 1 at corner c and 0 at the others. The conditions and what their
// gradients are with respect to (w_u, w_v):
//     C_u = |w_u| - r_u:   (n_u, 0),  n_u = w_u/|w_u|        C_v = |w_v| - r_v:   (0, n_v)
//     C_s = w_u·w_v:       (w_v, w_u)
// A triangle pressed to a point or a line may leave n_u or n_v undefined: the forces are then not a number
// and the step reports that it diverged.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solvers/scene/elements.h"

namespace springstab {

/// A triangle and where its corners lie in the cloth at rest. Either orientation.
struct RestTriangle {
  std::array<int, 3> particles;
  std::array<Eigen::Vector2d, 3> uv;  // [m]
};

/// One number for each condition on a triangle.
struct PerTriangleCondition {
  double stretch_u = 0, stretch_v = 0, shear = 0;

  PerTriangleCondition scaled(double s) const { return {s * stretch_u, s * stretch_v, s * shear}; }
};

/// How an energy and a damping depend on a triangle's area A at rest.
enum class AreaScaling {
  continuum,  // E = ½ κ A C², κ in N/m, damping in N·s/m: a sheet's energy does not depend on its triangles
  original,  // E = ½ κ A² C² as in the article, where A is a factor of C; κ in N/m³, damping in N·s/m³
};

/// The state of one triangle.
struct Deformation {
  Vec3 w_u, w_v;    // dimensionless
  Vec3 n_u, n_v;    // their directions
  double l_u, l_v;  // their lengths
  double shear;     // w_u·w_v
};

/// The second derivatives of an energy with respect to (w_u, w_v): [[uu, uv], [uvᵀ, vv]].
struct DeformationHessian {
  Mat3 uu, vv, uv;
};

/// The triangles of a cloth, shared by its energy and its damping.
class TriangleConditions {
 public:
  /// Particle numbers are a scene's own: free ones first, `free_count` of them.
  /// Throws std::invalid_argument for a triangle without area in (u, v).
  TriangleConditions(const std::vector<RestTriangle>& triangles, AreaScaling scaling, int free_count);

  /// The shapes of a batch of triangles at rest.
  struct alignas(64) Shapes {
    double a1[batch_size], a2[batch_size], b1[batch_size], b2[batch_size];  // [1/m]
    double weight[batch_size];                                              // A or A²

    [[gnu::always_inline]] double a0(int lane) const { return -(a1[lane] + a2[lane]); }
    [[gnu::always_inline]] double b0(int lane) const { return -(b1[lane] + b2[lane]); }

    [[gnu::always_inline]] Vec3 along_u(const CornerVectors<3>& x, int lane) const {
      return a1[lane] * (x.get(1, lane) - x.get(0, lane)) + a2[lane] * (x.get(2, lane) - x.get(0, lane));
    }
    [[gnu::always_inline]] Vec3 along_v(const CornerVectors<3>& x, int lane) const {
      return b1[lane] * (x.get(1, lane) - x.get(0, lane)) + b2[lane] * (x.get(2, lane) - x.get(0, lane));
    }

    [[gnu::always_inline]] Deformation deformation(const CornerVectors<3>& x, int lane) const {
      const Vec3 w_u = along_u(x, lane), w_v = along_v(x, lane);
      const double l_u = std::sqrt(dot(w_u, w_u)), l_v = std::sqrt(dot(w_v, w_v));
      return {w_u, w_v, (1 / l_u) * w_u, (1 / l_v) * w_v, l_u, l_v, dot(w_u, w_v)};
    }

    /// out = (∂w_u/∂x)ᵀ f_u + (∂w_v/∂x)ᵀ f_v.
    [[gnu::always_inline]] void pull_back(const Vec3& f_u, const Vec3& f_v, int lane,
                                          CornerVectors<3>& out) const {
      const Vec3 f1 = a1[lane] * f_u + b1[lane] * f_v, f2 = a2[lane] * f_u + b2[lane] * f_v;
      out.set(0, lane, -(f1 + f2));
      out.set(1, lane, f1);
      out.set(2, lane, f2);
    }

    /// out = Σ s ∇C over the conditions.
    [[gnu::always_inline]] void combine_gradients(const Deformation& d, const PerTriangleCondition& s,
                                                  int lane, CornerVectors<3>& out) const {
      pull_back(s.stretch_u * d.n_u + s.shear * d.w_v, s.stretch_v * d.n_v + s.shear * d.w_u, lane, out);
    }

    /// out = (∂w/∂x)ᵀ h (∂w/∂x).
    [[gnu::always_inline]] void pull_back(const DeformationHessian& h, int lane, CornerBlocks<3>& out) const {
      const Mat3 vu = transposed(h.uv);
      const auto block = [&](double a, double b, double c, double d) {
        return (a * c) * h.uu + (b * d) * h.vv + (a * d) * h.uv + (b * c) * vu;
      };
      const double a[3] = {a0(lane), a1[lane], a2[lane]}, b[3] = {b0(lane), b1[lane], b2[lane]};
      out.set(0, 0, lane, block(a[0], b[0], a[0], b[0]));
      out.set(0, 1, lane, block(a[0], b[0], a[1], b[1]));
      out.set(0, 2, lane, block(a[0], b[0], a[2], b[2]));
      out.set(1, 1, lane, block(a[1], b[1], a[1], b[1]));
      out.set(1, 2, lane, block(a[1], b[1], a[2], b[2]));
      out.set(2, 2, lane, block(a[2], b[2], a[2], b[2]));
    }
  };

  /// Σ s ∇C∇Cᵀ over the conditions: positive semidefinite for s >= 0.
  [[gnu::always_inline]] static DeformationHessian gradient_products(const Deformation& d,
                                                                     const PerTriangleCondition& s) {
    return {outer(s.stretch_u * d.n_u, d.n_u) + outer(s.shear * d.w_v, d.w_v),
            outer(s.stretch_v * d.n_v, d.n_v) + outer(s.shear * d.w_u, d.w_u), outer(s.shear * d.w_v, d.w_u)};
  }

  const Elements<3>& elements() const { return elements_; }
  const Shapes& shapes(int batch) const { return shapes_[batch]; }

 private:
  Elements<3> elements_;
  std::vector<Shapes> shapes_;
};

}  // namespace springstab
