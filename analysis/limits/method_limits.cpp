#include "analysis/limits/method_limits.h"

#include <algorithm>
#include <cmath>

namespace springstab {
namespace {

std::optional<double> positive(double h) { return h > 0 ? std::optional(h) : std::nullopt; }

constexpr std::string_view indefinite_stiffness = "K is indefinite";

LimitStatus status_of(double h) {
  return h == 0 ? LimitStatus::none : std::isinf(h) ? LimitStatus::unlimited : LimitStatus::limited;
}

}  // namespace

void keep_margin(double safety, MethodLimits& limits) {
  if (!limits.recommended) return;
  double& step = *limits.recommended;
  if (limits.h_max) step = std::min(step, *limits.h_max / std::sqrt(safety));
  if (limits.h_certified) step = std::min(step, *limits.h_certified);
}

MethodLimits method_limits(const Method& method, const StiffestMode& k0, const DampingModel& damping,
                           double safety) {
  const StabilityRegion& region = stability_region(method);
  MethodLimits limits;
  if (!k0.converged) {
    limits.unproved = "k0 did not converge";
    return limits;
  }
  if (damping.kind == DampingModel::Kind::general) {
    if (k0.indefinite || !damping.semidefinite) {
      limits.unproved = k0.indefinite ? indefinite_stiffness : "D is indefinite";
    } else if (region.constants().covers_quadrant && region.matrix_form() != MatrixForm::none) {
      limits.status = LimitStatus::unlimited;
      limits.h_max = limits.h_certified = std::numeric_limits<double>::infinity();
      limits.proof = Proof::quadrant;
    }
    return limits;
  }

  const double k_max = std::max(k0.value, 0.0);
  const double proof_margin = 1 - 1e-12;  // for the rounding of the limit itself
  const auto prove = [&](const auto& limit_up_to) {
    if (limits.status == LimitStatus::none) {
      limits.unproved = "no positive step is stable";
    } else if (k0.indefinite) {
      limits.unproved = indefinite_stiffness;
    } else if (!std::isfinite(k0.upper_bound)) {
      limits.unproved = "k0 has no proved bound";
    } else if (limits.h_certified = positive(proof_margin * limit_up_to(k0.upper_bound));
               limits.h_certified) {
      limits.proof = Proof::k0_bound;
    } else {
      limits.unproved = "no positive step is stable up to the bound on k0";
    }
  };
  limits.designed = design_damping(region, k_max, damping.d0);
  if (damping.kind == DampingModel::Kind::designed) {
    limits.status = status_of(limits.designed->h_max);
    limits.h_max = positive(limits.designed->h_max);
    prove([&](double k) { return design_damping(region, k, damping.d0).h_max; });
    if (limits.status == LimitStatus::limited)
      limits.recommended = positive(design_damping(region, safety * k_max, damping.d0).h_max);
    keep_margin(safety, limits);
    return limits;
  }

  const RayleighModes modes{std::clamp(k0.smallest.value_or(0), 0.0, k_max), k_max, damping.d0, damping.alpha,
                            k0.indefinite ? std::min(k0.lowest.value_or(0), 0.0) : 0};
  const double h_max = critical_step(region, modes);
  limits.status = status_of(h_max);
  limits.h_max = positive(h_max);
  if (limits.status == LimitStatus::limited)
    limits.recommended = positive(recommended_step(region, modes, safety));
  prove([&](double k) { return critical_step(region, {0, k, damping.d0, damping.alpha}); });
  keep_margin(safety, limits);
  return limits;
}

}  // namespace springstab
