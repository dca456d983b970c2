#include "analysis/proofs/certified_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/spectra/rigid_motions.h"

namespace springstab {
namespace {

constexpr double loose = 1e-3;                          // of eigenvectors that only guide the search
constexpr double first_margin = 1e-4, unlikely = 1e-3;  // of steps below those of the known points
constexpr double negligible = 1e-9;                     // h√k0 that damping of rounding's size allows

// `proof`, but for what follows from what was proved.
DefinitenessTest remembering(DefinitenessTest proof, std::shared_ptr<ProvedHalfPlanes> known) {
  return [proof = std::move(proof), known = std::move(known)](double c, double a, double b) {
    if (known->imply(c, a, b)) return true;
    const bool holds = proof(c, a, b);
    if (holds) known->add(c, a, b);
    return holds;
  };
}

}  // namespace

// An edge through the origin, c = 0, is a condition on K and D alone, which rigid motions leave at zero; all
// others have c M to make them definite.
struct CertifiedSteps::Restricted {
  StructuralMatrices s;
  NumericalRange range;
  DefinitenessProof proof;
  DefinitenessTest test;
  bool searched = false;  // for rigid motions, all of them

  Restricted(StructuralMatrices matrices, const ArpackOptions& options,
             const std::shared_ptr<ProvedHalfPlanes>& known)
      : s(std::move(matrices)), range(s, options), proof(&s), test(remembering(proof.test(), known)) {}
};

CertifiedSteps::CertifiedSteps(const StructuralMatrices& s, const ArpackOptions& options)
    : s_(&s), range_(std::make_shared<const NumericalRange>(s, options)), options_(options) {}

CertifiedSteps::CertifiedSteps(std::shared_ptr<const ExtremePoints> range, DefinitenessTest proof)
    : range_(std::move(range)) {
  proof_ = remembering(std::move(proof), known_);
}

const DefinitenessTest& CertifiedSteps::proof() {
  if (!proof_) {
    const auto proof = std::make_shared<DefinitenessProof>(s_);
    proof_ = remembering([proof](double c, double a, double b) { return proof->holds(c, a, b); }, known_);
  }
  return proof_;
}

CertifiedSteps::Restricted& CertifiedSteps::restricted() {
  if (restricted_) return *restricted_;
  std::optional<StructuralMatrices> quickly = without_free_unknowns(*s_);
  const bool searched = !quickly;
  restricted_ = std::make_shared<Restricted>(quickly ? std::move(*quickly) : without_rigid_motions(*s_),
                                             options_, known_);
  restricted_->searched = searched;
  return *restricted_;
}

// Whether that holds any more: a proof of the others fails where a rigid motion is left.
bool CertifiedSteps::hold_rigid_motions() {
  if (restricted().searched) return false;
  restricted_->searched = true;
  StructuralMatrices rest = without_rigid_motions(*s_);
  if (rest.size() == restricted_->s.size()) return false;
  restricted_ = std::make_shared<Restricted>(std::move(rest), options_, known_);
  restricted_->searched = true;
  return true;
}

const std::vector<ModePoint>& CertifiedSteps::outline() {
  if (!outline_.empty()) return outline_;
  const auto stiffest = range_->farthest(0, 1, loose), most_damped = range_->farthest(1, 0, loose);
  if (!stiffest || !most_damped) return outline_;
  outline_ = {{stiffest->d, stiffest->k}, {most_damped->d, most_damped->k}};
  if (!(stiffest->k > 0 && most_damped->d > 0)) return outline_;
  for (const double angle : {0.125, 0.25, 0.375})
    if (const auto p = range_->farthest(std::sin(std::numbers::pi * angle) / most_damped->d,
                                        std::cos(std::numbers::pi * angle) / stiffest->k, loose))
      outline_.push_back(*p);
  return outline_;
}

std::optional<ExtremePoint> CertifiedSteps::farthest(const HalfPlane& edge, double h,
                                                     const Stiffening& stiffening) {
  const double a = edge.x * h, b = edge.y * h * h;
  const ExtremePoints& range = edge.bound == 0 ? restricted().range : *range_;
  return range.farthest(a, a * stiffening.added_damping + b * stiffening.factor, loose);
}

// The polygon that is best for the known points of W, then an edge that does not hold for all of W, whose
// farthest point becomes known; until all edges hold.
template <class Holds>
std::optional<double> CertifiedSteps::search(const Method& method, const Stiffening& stiffening,
                                             const Holds& holds) {
  if (outline().empty()) return std::nullopt;
  std::vector<ModePoint> modes;
  for (const ModePoint& p : outline_) modes.push_back(stiffening(p));
  const double shortest = modes.front().k > 0 ? negligible / std::sqrt(modes.front().k) : 0;
  double margin = first_margin;
  for (int round = 0; round < 60 && margin < 0.5; ++round) {
    PolygonFit fit = inscribed_polygons(method).fit(modes);
    if (!(fit.h > shortest) || fit.edges.empty() || !std::isfinite(fit.h)) return std::nullopt;
    const bool from_origin = std::any_of(fit.edges.begin(), fit.edges.end(),
                                         [](const HalfPlane& edge) { return edge.bound == 0; });
    if (from_origin && (!s_ || s_->size() > SparseCholesky::unknowns_limit)) return std::nullopt;
    const double h = fit.h * (1 - margin);
    const auto room = [&](const HalfPlane& edge) {
      double least = std::numeric_limits<double>::infinity();
      for (const ModePoint& p : modes) least = std::min(least, exit_step(edge, p));
      return least;
    };
    std::sort(fit.edges.begin(), fit.edges.end(),
              [&](const HalfPlane& p, const HalfPlane& q) { return room(p) < room(q); });
    const auto failed = std::find_if_not(fit.edges.begin(), fit.edges.end(),
                                         [&](const HalfPlane& edge) { return holds(edge, h); });
    if (failed == fit.edges.end()) return h;
    const std::optional<ExtremePoint> p = farthest(*failed, h, stiffening);
    if (!p) return std::nullopt;
    if (exit_step(*failed, stiffening(*p)) >= h) {  // what rounding and tolerance leave open
      if (failed->bound == 0 && margin >= unlikely && hold_rigid_motions()) {
        margin = first_margin;
        continue;
      }
      margin *= 4;
    }
    outline_.push_back(*p);
    modes.push_back(stiffening(*p));
  }
  return std::nullopt;
}

std::optional<double> CertifiedSteps::certified(const Method& method) {
  return search(method, {}, [&](const HalfPlane& edge, double h) {
    const double c = edge.bound, a = edge.x * h, b = edge.y * h * h;
    return c == 0 ? restricted().test(c, a, b) : proof()(c, a, b);
  });
}

std::optional<double> CertifiedSteps::estimated(const Method& method, const Stiffening& stiffening) {
  return search(method, stiffening, [&](const HalfPlane& edge, double h) {
    const double a = edge.x * h, b = edge.y * h * h;
    if (known_->imply(edge.bound, a, a * stiffening.added_damping + b * stiffening.factor)) return true;
    const std::optional<ExtremePoint> p = farthest(edge, h, stiffening);
    return p && exit_step(edge, stiffening(*p)) >= h;
  });
}

}  // namespace springstab
