// The in-plane energy of Baraff's and Witkin's cloth as a term of a scene. With the conditions of
// triangle_conditions.h, the weight q = A or A² of the area scaling, and k = κ q for each condition,
//     E = ½ Σ k C²,   f = -Σ k C ∇C,   K = Σ k (∇C∇Cᵀ + C ∇∇C).
// With respect to (w_u, w_v) the second part is
//     k_u C_u ∇∇C_u = t_u (I - n_u n_uᵀ) on w_u,  t_u = k_u (1 - r_u/|w_u|); likewise v;
//     k_s C_s ∇∇C_s = k_s C_s [[0, I], [I, 0]].
// The first stiffens a stretched triangle out of its plane and makes a compressed one buckle; the second has
// the eigenvalues ±k_s C_s, so a sheared triangle is always soft in some direction.
#pragma once

#include "solvers/scene/triangle_conditions.h"

namespace springstab {

/// The lengths r_u, r_v of w_u, w_v at which a triangle is not stretched. Other than 1 where a part of the
/// cloth is to shrink or widen along one direction.
struct RestStretch {
  double u = 1, v = 1;
};

class StretchShear final : public ElasticTerm {
 public:
  /// stiffness: κ [N/m], or [N/m³] with the original scaling, not negative.
  StretchShear(std::shared_ptr<const TriangleConditions> triangles, const PerTriangleCondition& stiffness,
               const RestStretch& rest = {});

  std::string_view name() const override { return "triangles that resist stretch and shear"; }
  int size() const override { return triangles_->elements().size(); }
  double energy(const ParticleField& x) const override;
  void add_force(const ParticleField& x, double* force) const override;
  void add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const override;
  void add_damped_force(const ParticleField& x, const double* v, double alpha, double* force) const override;
  Couplings couplings() const override;
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

  /// stiffness += a positive semidefinite matrix: of each condition the gradient product k ∇C∇Cᵀ and the
  /// positive part of k C ∇∇C, that is max(t, 0)(I - nnᵀ) for stretch and ½ k_s |C_s| [[I, ±I], [±I, I]] for
  /// shear, ± the sign of C_s. Each summand is positive semidefinite in (w_u, w_v), so their sum is, and so
  /// is its pull-back (∂w/∂x)ᵀ H (∂w/∂x). It is K itself where nothing is compressed along u or v and nothing
  /// sheared.
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

  /// Looks up once where the blocks are in a matrix that outlives this term; other matrices are filled
  /// slowly.
  void bind(const SharedPattern& pattern) override { places_.bind(triangles_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  template <bool with_force>
  void add_products(const ParticleField& x, const double* u, double scale, double* out) const;

  enum class Curvature { exact, positive };
  template <Curvature curvature>
  void add_blocks(const ParticleField& x, BlockSparseMatrix& stiffness) const;

  std::shared_ptr<const TriangleConditions> triangles_;
  PerTriangleCondition stiffness_;
  RestStretch rest_;
  BlockPlaces<3> places_;
};

}  // namespace springstab
