#include "analysis/proofs/certified_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/constants.h"
#include "analysis/proofs/sum_of_couplings.h"
#include "analysis/spectra/rigid_motions.h"

namespace springstab {
namespace {

constexpr double loose = 1e-3;                          // of eigenvectors that only guide the search
constexpr double first_margin = 1e-4, unlikely = 1e-3;  // of steps below those of the known points
constexpr double nearly = 2e-3;                         // of a step that may be lost to a cheaper proof
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

// Null where there is none.
const HalfPlane* edge_through_origin(const PolygonFit& fit) {
  const auto edge =
      std::find_if(fit.edges.begin(), fit.edges.end(), [](const HalfPlane& side) { return side.bound == 0; });
  return edge == fit.edges.end() ? nullptr : &*edge;
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

CertifiedSteps::CertifiedSteps(std::shared_ptr<const ExtremePoints> range, DefinitenessTest proof,
                               double coupling_ratio)
    : range_(std::move(range)), coupling_ratio_(coupling_ratio) {
  proof_ = remembering(std::move(proof), known_);
  know(0, -1, coupling_ratio);
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
  const ExtremePoints& range = edge.bound == 0 && s_ ? restricted().range : *range_;
  return range.farthest(a, a * stiffening.added_damping + b * stiffening.factor, loose);
}

// ρ with D - ρ K positive semidefinite by its couplings; 0 where none is known.
double CertifiedSteps::coupling_ratio() {
  if (!coupling_ratio_) {
    const std::optional<double> ratio = springstab::coupling_ratio(*s_, {0, s_->size()});
    coupling_ratio_ = ratio && std::isfinite(*ratio) ? *ratio : 0;
    know(0, -1, *coupling_ratio_);
  }
  return *coupling_ratio_;
}

// The polygon that is best for these modes. Of many unknowns an edge through the origin holds without a
// factorization where it asks for no more than the coupling ratio, whose direction is then one more mode:
// that polygon is taken where it is nearly as good, or there is no factorization. No edges where no polygon
// can be proved.
PolygonFit CertifiedSteps::fit(const Method& method, const Stiffening& stiffening,
                               std::vector<ModePoint>& modes) {
  const InscribedPolygons& polygons = inscribed_polygons(method);
  PolygonFit best = polygons.fit(modes);
  const HalfPlane* const edge = edge_through_origin(best);
  if (!edge || (s_ && s_->size() < many_unknowns)) return best;
  const bool factorized = s_ && s_->size() <= SparseCholesky::unknowns_limit;
  if (const double ratio = coupling_ratio(); ratio > 0) {
    if (factorized && !restricted_)  // how far W reaches that way
      if (const auto p = farthest(*edge, best.h, stiffening)) {
        outline_.push_back(*p);
        modes.push_back(stiffening(*p));
        best = polygons.fit(modes);
      }
    std::vector<ModePoint> more = modes;
    const double k = negligible * outline_.front().k;
    more.push_back(stiffening({ratio * k, k}));
    PolygonFit sure = polygons.fit(more);
    if (!factorized || sure.h >= (1 - nearly) * best.h) return sure;
  }
  return factorized ? best : PolygonFit{};
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
    PolygonFit fit = this->fit(method, stiffening, modes);
    if (!(fit.h > shortest) || fit.edges.empty() || !std::isfinite(fit.h)) return std::nullopt;
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
      if (s_ && failed->bound == 0 && margin >= unlikely && hold_rigid_motions()) {
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
    if (c > 0) return proof()(c, a, b);
    return known_->imply(c, a, b) || (s_ && restricted().test(c, a, b));
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
