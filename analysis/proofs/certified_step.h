// Steps that are proved stable for any symmetric positive semidefinite M, K, D, whether D' and K' commute or
// not.
//
// An eigenpair (μ, v) of the damped system obeys μ² + (v*D'v) μ + v*K'v = 0: it is one of the scalar mode
// (d, k) = (v*D'v, v*K'v), a point of the joint numerical range W. So where W, scaled to (h d, h² k), lies
// inside a convex polygon inside the method's region, the method is stable. An edge a X + b Y <= c holds on
// all of W iff c M - a h D - b h² K is positive semidefinite, and a Cholesky factorization proves that, or
// where c = 0 that no coupling has a damper too weak for its stiffness.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "analysis/proofs/definiteness.h"
#include "analysis/proofs/inscribed_polygon.h"
#include "analysis/proofs/proved_half_planes.h"
#include "analysis/spectra/numerical_range.h"

namespace springstab {

class CertifiedSteps {
 public:
  /// `s`, whose K and D are positive semidefinite, must outlive it.
  explicit CertifiedSteps(const StructuralMatrices& s, const ArpackOptions& options = {});
  explicit CertifiedSteps(StructuralMatrices&&, const ArpackOptions& = {}) = delete;
  /// Of a structure that only these know, with its coupling_ratio, or 0 (analysis/proofs/sum_of_couplings.h).
  /// Of polygons with an edge through the origin, where a factorization would ask for the structure without
  /// its rigid motions, only those that follow from that prove something then.
  CertifiedSteps(std::shared_ptr<const ExtremePoints> range, DefinitenessTest proof,
                 double coupling_ratio = 0);

  const ExtremePoints& range() const { return *range_; }
  /// The proofs of the whole structure; made when first asked for. What follows from earlier ones is not
  /// factorized.
  const DefinitenessTest& proof();
  /// c M - a D - b K is known to be positive semidefinite, as where k0 has a proved bound.
  void know(double c, double a, double b) { known_->add(c, a, b); }

  /// A step proved stable; nothing where there is none in the polygons, as for explicit Euler when D is
  /// singular on motions that K resists, or where eigenvalues did not converge.
  std::optional<double> certified(const Method& method);

  /// Points of W: those with the largest k and d, and where an edge of a polygon has bound. Empty where
  /// eigenvalues did not converge.
  const std::vector<ModePoint>& outline();

  /// What `certified` would be for the stiffened structure, by eigenvalues instead of proofs.
  std::optional<double> estimated(const Method& method, const Stiffening& stiffening);

 private:
  struct Restricted;  // the structure without its rigid motions

  double coupling_ratio();
  PolygonFit fit(const Method& method, const Stiffening& stiffening, std::vector<ModePoint>& modes);
  template <class Holds>
  std::optional<double> search(const Method& method, const Stiffening& stiffening, const Holds& holds);
  std::optional<ExtremePoint> farthest(const HalfPlane& edge, double h, const Stiffening& stiffening);
  Restricted& restricted();
  bool hold_rigid_motions();

  const StructuralMatrices* s_ = nullptr;  // where there is more than the next two
  std::shared_ptr<const ExtremePoints> range_;
  DefinitenessTest proof_;
  std::shared_ptr<ProvedHalfPlanes> known_ = std::make_shared<ProvedHalfPlanes>();
  std::optional<double> coupling_ratio_;
  ArpackOptions options_;
  std::shared_ptr<Restricted> restricted_;
  std::vector<ModePoint> outline_;  // points of W, more where a polygon's edge asked for them
};

}  // namespace springstab
