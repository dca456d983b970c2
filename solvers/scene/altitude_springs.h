// Springs along the altitudes of tetrahedra as terms of a scene: what makes a net of edge springs keep its
// volume. After Selle, Lentine and Fedkiw, "A mass spring model for hair simulation" (2008), and Molino,
// Bridson, Teran and Fedkiw, "A crystalline, red green strategy for meshing highly deformable objects"
// (2003).
//
// Of an apex x0 over the face (x1, x2, x3), with N = (x2 - x1) × (x3 - x1) and n = N/|N|, the altitude is
// signed,
//     h = n·(x0 - x1),     E = ½ k (h - h0)²,     f = -k (h - h0) ∇h,     K = k ∇h∇hᵀ + k (h - h0) ∇∇h.
// With the barycentric coordinates w_i of the apex's foot in the face (their sum is 1) and their gradients
// b_i = n × (x_{i+2} - x_{i+1})/|N| in its plane (their sum is 0), ρ = (1, -w_1, -w_2, -w_3) and
// β = (0, b_1, b_2, b_3):
//     δh = n·r,  r = Σ ρ_c δx_c;     δn = -Σ β_c (n·δx_c);     δw_i = b_i·(r - h δn),
// and differentiating once more, for two displacements δ and δ',
//     δ'δh = δ'n·r + δn·r' - h δn·δ'n,   so block (c, d) of ∇∇h is -ρ_c β_d nᵀ - ρ_d n β_cᵀ - h (β_c·β_d) n
//     nᵀ.
// The damper along it resists the altitude's rate alone: f = -k_d ∇h (∇hᵀ v), C = k_d ∇h∇hᵀ.
//
// When the tetrahedron is pushed flat, h passes through zero and becomes negative: energy, force and
// stiffness are smooth there, and the force still drives the apex back to its own side, so an inverted
// tetrahedron recovers. Only a face that is pressed towards a line has no normal: w and with it the force
// grow like the inverse of the face's height, and on the line they are not a number, so that the step reports
// that it diverged. Checked against differences in tests/test_tet_solid.cpp.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "solvers/scene/elements.h"

namespace springstab {

/// Particle 0 is the apex, 1 to 3 are the face, from whose front (they turn counterclockwise) h counts
/// positive.
struct Altitude {
  std::array<int, 4> particles;
  double rest = 0;  // h0 [m]
};

/// h of the four corners of an altitude [m].
double altitude(const std::array<Eigen::Vector3d, 4>& corners);

/// The altitudes of a solid, shared by its springs and its dampers.
class Altitudes {
 public:
  /// Particle numbers are a scene's own: free ones first, `free_count` of them.
  Altitudes(const std::vector<Altitude>& altitudes, int free_count);

  struct alignas(64) Rest {
    double h[batch_size];
  };

  const Elements<4>& elements() const { return elements_; }
  const Rest& rest(int batch) const { return rest_[batch]; }

  /// matrix += factor · Σ ∇h∇hᵀ: positive semidefinite for factor >= 0.
  void add_gradient_products(const ParticleField& x, double factor, const BlockPlaces<4>& places,
                             BlockSparseMatrix& matrix) const;

 private:
  Elements<4> elements_;
  std::vector<Rest> rest_;
};

class AltitudeSprings final : public ElasticTerm {
 public:
  /// stiffness: k [N/m], not negative.
  AltitudeSprings(std::shared_ptr<const Altitudes> altitudes, double stiffness);

  std::string_view name() const override { return "altitude springs"; }
  int size() const override { return altitudes_->elements().size(); }
  double energy(const ParticleField& x) const override;
  void add_force(const ParticleField& x, double* force) const override;
  void add_stiffness_times(const ParticleField& x, const double* u, double scale, double* out) const override;
  Couplings couplings() const override { return altitudes_->elements().couplings(); }
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;
  /// stiffness += the Gauss-Newton part k ∇h∇hᵀ, positive semidefinite; it is K where h = h0.
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override;

  /// Looks up once where the blocks are in a matrix that outlives this term; other matrices are filled
  /// slowly.
  void bind(const SharedPattern& pattern) override { places_.bind(altitudes_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  std::shared_ptr<const Altitudes> altitudes_;
  double stiffness_;  // [N/m]
  BlockPlaces<4> places_;
};

class AltitudeDamping final : public DampingTerm {
 public:
  /// damping: k_d [N·s/m], not negative.
  AltitudeDamping(std::shared_ptr<const Altitudes> altitudes, double damping);

  std::string_view name() const override { return "dampers along altitudes"; }
  int size() const override { return altitudes_->elements().size(); }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override;
  Couplings couplings() const override { return altitudes_->elements().couplings(); }
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override;
  void bind(const SharedPattern& pattern) override { places_.bind(altitudes_->elements(), pattern); }
  void unbind() override { places_.unbind(); }

 private:
  std::shared_ptr<const Altitudes> altitudes_;
  double damping_;  // [N·s/m]
  BlockPlaces<4> places_;
};

}  // namespace springstab
