#include "analysis/limits/matrix_condition.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "analysis/spectra/lanczos.h"

namespace springstab {
namespace {

// The positive root of a h d + b h² k = c, without cancellation; ∞ where there is none.
double root(double a, double b, double c, const ModePoint& p, bool signed_damping) {
  const double linear = a * (signed_damping ? p.d : std::max(p.d, 0.0)), quadratic = b * std::max(p.k, 0.0);
  const double discriminant = std::hypot(linear, 2 * std::sqrt(c * quadratic));
  if (linear < 0) return quadratic > 0 ? (discriminant - linear) / (2 * quadratic) : infinity;
  return 2 * c / (linear + discriminant);
}

}  // namespace

double proof_gap(const ArpackOptions& options) { return std::max(1e-10, options.tolerance / 2); }

// Newton's method on λ_max, from above: a unit vector's own root is an upper bound, and the eigenvector at h
// has the root to second order. The way there needs no accurate eigenvectors. With a < 0, too, every vector's
// steps are those below its one positive root.
std::optional<double> exact_limit(const ExtremePoints& range, const HalfPlane& condition,
                                  const Stiffening& stiffening, bool signed_damping) {
  const auto& [a, b, c] = condition;
  // A residual r leaves an error of about r² in λ, over the gap. The safety factor covers far more.
  constexpr double first = 1e-2, loose = 1e-3, sharp = 1e-7, stiffened = 1e-5;
  const double last = stiffening.factor == 1 ? sharp : stiffened;
  const bool few_digits = range.tolerance() > lanczos_tolerance;
  const double last_change = few_digits ? range.tolerance() / 100 : 1e-6;
  double h = infinity;
  Eigen::VectorXd near;
  for (const auto& [x, y] : {std::pair{0.0, 1.0}, {1.0, 0.0}}) {
    const std::optional<ExtremePoint> p = range.farthest(x, y, few_digits ? last : first);
    if (!p) return std::nullopt;
    if (const double next = root(a, b, c, stiffening(*p), signed_damping); next < h)
      h = next, near = p->vector;
  }
  double tolerance = few_digits ? last : loose;
  for (int i = 0; i < 50 && std::isfinite(h); ++i) {
    const double x = a * h, y = b * h * h;
    const std::optional<ExtremePoint> p =
        range.farthest(x, x * stiffening.added_damping + y * stiffening.factor, tolerance, near);
    if (!p) return std::nullopt;
    near = p->vector;
    const double next = std::min(h, root(a, b, c, stiffening(*p), signed_damping));
    const double change = 1 - next / h;
    h = next;
    if (tolerance == last && change < last_change) break;  // the next change is about its square
    if (change < 1e-3) tolerance = last;
  }
  return h;
}

std::optional<double> proved_limit(const DefinitenessTest& proof, const HalfPlane& condition, double h,
                                   double gap) {
  if (!std::isfinite(h)) return h;
  const auto holds = [&](double step) {
    return proof(condition.bound, condition.x * step, condition.y * step * step);
  };
  double failed = 0;
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
                                   ArpackOptions options) {
  const double gap = proof_gap(options);
  options.tolerance = std::max(options.tolerance, 1e-6);  // only guides the proof
  const std::optional<double> h = exact_limit(NumericalRange(s, options), condition);
  if (!h) return std::nullopt;
  DefinitenessProof proof(&s);
  return proved_limit(proof.test(), condition, *h, gap);
}

}  // namespace springstab
