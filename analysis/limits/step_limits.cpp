#include "analysis/limits/step_limits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/constants.h"
#include "analysis/gsl/numerics.h"

namespace springstab {
namespace {

void check(const RayleighModes& m) {
  for (double value : {m.k_min, m.k_max, m.d0, m.alpha})
    if (!(value >= 0 && std::isfinite(value)))
      throw std::invalid_argument("a mode's stiffness or damping is " + std::to_string(value) +
                                  ", expected finite and not negative");
  if (!(m.k_lowest <= 0 && std::isfinite(m.k_lowest)))
    throw std::invalid_argument("k_lowest is " + std::to_string(m.k_lowest) +
                                ", expected finite and not positive");
  if (m.k_min > m.k_max) throw std::invalid_argument("k_min is larger than k_max");
}

// The smallest limit(k) for k from `from` to `to`, of one sign. Each mode's limit is exact; over the modes it
// is scanned in log |k| and every local minimum refined. What depends on k is only the ratio d/√|k|, which
// varies slowly in log |k|, so nothing hides between the samples.
template <class Limit>
double smallest_limit(const Limit& limit_of, double from, double to, bool damped) {
  const double sign = to < 0 || from < 0 ? -1 : 1;
  const auto limit = [&](double size) { return limit_of(sign * size); };
  const double least = std::min(std::abs(from), std::abs(to)), most = std::max(std::abs(from), std::abs(to));
  double smallest = std::min(limit(least), limit(most));
  if (least == most || !damped) return smallest;

  constexpr int samples = 240;
  const double top = std::log(most);
  const double bottom = std::log(std::max(least, 1e-16 * most));
  const auto log_limit = [&](double log_k) { return limit(std::exp(log_k)); };
  std::vector<double> at, value;
  for (int i = 0; i <= samples; ++i) {
    at.push_back(bottom + (top - bottom) * i / samples);
    value.push_back(log_limit(at.back()));
    smallest = std::min(smallest, value.back());
  }
  for (std::size_t i = 1; i + 1 < at.size(); ++i)
    if (value[i] < value[i - 1] && value[i] < value[i + 1] && value[i] < 1.1 * smallest)
      smallest = std::min(smallest, minimum_near(log_limit, at[i - 1], at[i], at[i + 1]));
  return smallest;
}

}  // namespace

double critical_step(const StabilityRegion& region, const RayleighModes& modes) {
  check(modes);
  const auto damping = [&](double k) { return modes.d0 + modes.alpha * k; };
  const bool damped = modes.d0 > 0 || modes.alpha > 0;
  const double h = smallest_limit([&](double k) { return region.critical_step(k, damping(k)); }, modes.k_min,
                                  modes.k_max, damped);
  if (modes.k_lowest == 0) return h;
  return std::min(h,
                  smallest_limit([&](double k) { return region.critical_step_beside_growth(k, damping(k)); },
                                 modes.k_lowest, 1e-16 * modes.k_lowest, damped));
}

double designed_alpha(const StabilityRegion& region, double h, double d0) {
  return h * region.damping_line(h * d0).slope;
}

double designed_alpha(const Method& method, double h, double d0) {
  if (method.info().implicit_damping == DampingPart::diagonal) return 0;
  return designed_alpha(stability_region(method), h, d0);
}

DampingDesign design_damping(const StabilityRegion& region, double k_max, double d0) {
  check({.k_max = k_max, .d0 = d0});
  const double base_limit = d0 > 0 ? region.constants().real_interval / d0 : infinity;
  const RegionConstants& c = region.constants();
  // A region may reach to ∞ without covering the quadrant, beside a pole.
  const double highest =
      c.y_max < infinity || c.covers_quadrant || d0 > 0 ? c.y_max : region.damping_line(0).reach;
  const double apex_limit = k_max > 0 ? std::sqrt(highest / k_max) : infinity;
  double upper = std::min(base_limit, apex_limit);
  if (upper == infinity) return {infinity, k_max > 0 && !c.covers_quadrant ? infinity : 0};

  // Largest h whose best line from (h d0, 0) reaches h² k_max; the reach may jump, so all of (0, upper] is
  // scanned.
  const auto feasible = [&](double h) {
    return region.damping_line(h * d0).reach >= h * h * k_max * (1 - 1e-14);
  };
  const auto design = [&](double h) { return DampingDesign{h, designed_alpha(region, h, d0)}; };
  if (feasible(upper)) return design(upper);
  if (d0 == 0) {  // every step has the lines from the origin
    const auto [slope, reach] = region.damping_line(0);
    return {std::sqrt(reach / k_max), std::sqrt(reach / k_max) * slope};
  }
  constexpr int samples = 200;
  for (int i = samples - 1; i > 0; --i) {
    double lower = upper * i / samples;
    if (!feasible(lower)) continue;
    double above = upper * (i + 1) / samples;
    while (above - lower > 1e-13 * above) {
      const double middle = (lower + above) / 2;
      (feasible(middle) ? lower : above) = middle;
    }
    return design(lower);
  }
  return {0, 0};
}

double recommended_step(const StabilityRegion& region, const RayleighModes& modes, double safety) {
  if (!(safety >= 1 && std::isfinite(safety)))
    throw std::invalid_argument("the safety factor is " + std::to_string(safety) + ", expected at least 1");
  RayleighModes stiffer{safety * modes.k_min, safety * modes.k_max, modes.d0, modes.alpha / safety,
                        safety * modes.k_lowest};
  const double damping_fixed = critical_step(region, stiffer);
  stiffer.alpha = modes.alpha;
  const double limit = critical_step(region, modes);
  return std::min({limit, damping_fixed, critical_step(region, stiffer), limit / std::sqrt(safety)});
}

// recommended_step falls as the factor grows.
std::optional<double> safety_for_step(const StabilityRegion& region, const RayleighModes& modes, double h,
                                      double most) {
  const auto short_enough = [&](double safety) {
    return recommended_step(region, modes, safety) <= h * (1 + 1e-12);
  };
  if (short_enough(1)) return 1;
  if (!short_enough(most)) return std::nullopt;
  double too_small = 1, enough = most;
  while (enough > too_small * (1 + 1e-4)) {
    const double middle = std::sqrt(too_small * enough);
    (short_enough(middle) ? enough : too_small) = middle;
  }
  return enough;
}

}  // namespace springstab
