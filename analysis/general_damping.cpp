#include "analysis/general_damping.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springstab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The positive root of a h d + b h² k = c, without cancellation; ∞ where there is none.
double root(double a, double b, double c, const ModePoint& p) {
  const double linear = a * std::max(p.d, 0.0), quadratic = b * std::max(p.k, 0.0);
  return 2 * c / (linear + std::hypot(linear, 2 * std::sqrt(c * quadratic)));
}

}  // namespace

// Newton's method on λ_max, from above: a unit vector's own root is an upper bound, and the eigenvector at h
// has the root to second order. The way there needs no accurate eigenvectors.
std::optional<double> exact_limit(const NumericalRange& range, const HalfPlane& condition,
                                  const Stiffening& stiffening) {
  const auto& [a, b, c] = condition;
  constexpr double loose = 1e-4;
  double h = infinity;
  Eigen::VectorXd near;
  for (const auto& [x, y] : {std::pair{0.0, 1.0}, {1.0, 0.0}}) {
    const std::optional<ExtremePoint> p = range.farthest(x, y, loose);
    if (!p) return std::nullopt;
    if (const double next = root(a, b, c, stiffening(*p)); next < h) h = next, near = p->vector;
  }
  double tolerance = loose;
  for (int i = 0; i < 50 && std::isfinite(h); ++i) {
    const double x = a * h, y = b * h * h;
    const std::optional<ExtremePoint> p =
        range.farthest(x, x * stiffening.added_damping + y * stiffening.factor, tolerance, near);
    if (!p) return std::nullopt;
    near = p->vector;
    const double next = std::min(h, root(a, b, c, stiffening(*p)));
    const double change = 1 - next / h;
    h = next;
    if (tolerance == 0 && change < 1e-6) break;  // the next change is about its square
    if (change < 1e-3) tolerance = 0;
  }
  return h;
}

std::optional<double> proved_limit(DefinitenessProof& proof, const HalfPlane& condition, double h) {
  if (!std::isfinite(h)) return h;
  const auto holds = [&](double step) {
    return proof.holds(condition.bound, condition.x * step, condition.y * step * step);
  };
  double gap = 1e-10, failed = 0;
  for (; !holds(h * (1 - gap)); gap = std::min(4 * gap, (1 + gap) / 2)) {
    failed = gap;
    if (gap > 1 - 1e-3) return std::nullopt;
  }
  while (gap - failed > 1e-3) {  // wide only where diagonal dominance alone proves
    const double middle = (gap + failed) / 2;
    (holds(h * (1 - middle)) ? gap : failed) = middle;
  }
  return h * (1 - gap);
}

std::optional<double> proved_limit(const StructuralMatrices& s, const HalfPlane& condition,
                                   const ArpackOptions& options) {
  const std::optional<double> h = exact_limit(NumericalRange(s, options), condition);
  if (!h) return std::nullopt;
  DefinitenessProof proof(s);
  return proved_limit(proof, condition, *h);
}

GeneralDamping::GeneralDamping(const StructuralMatrices& s, const StiffestMode& k0,
                               const DampingModel& damping, double safety, bool proofs,
                               const ArpackOptions& options)
    : k0_(k0), damping_(damping), safety_(safety), range_(s, options) {
  if (proofs) proof_.emplace(s);
}

GeneralDamping::~GeneralDamping() = default;

MethodLimits GeneralDamping::limits(std::string_view method) {
  MethodLimits limits = method_limits(method, k0_, damping_, safety_);
  if (limits.status != LimitStatus::unknown || !k0_.converged || k0_.indefinite || !damping_.semidefinite)
    return limits;
  if (const std::optional<HalfPlane> condition = stability_region(method).exact_condition())
    add_exact(*condition, limits);
  return limits;
}

void GeneralDamping::add_exact(const HalfPlane& condition, MethodLimits& limits) {
  const std::optional<double> h = exact_limit(range_, condition);
  const std::optional<double> damping_fixed = exact_limit(range_, condition, {safety_, 0});
  const std::optional<double> alpha_fixed =
      damping_.alpha > 0 ? exact_limit(range_, condition, {safety_, (safety_ - 1) * damping_.alpha})
                         : damping_fixed;
  if (!h || !damping_fixed || !alpha_fixed) return;
  limits.h_max = *h;
  limits.status = std::isinf(*h) ? LimitStatus::unlimited : LimitStatus::limited;
  if (proof_) limits.h_certified = proved_limit(*proof_, condition, *h);
  if (limits.status == LimitStatus::limited)
    limits.recommended = std::min({*h, *damping_fixed, *alpha_fixed});
}

}  // namespace springstab
