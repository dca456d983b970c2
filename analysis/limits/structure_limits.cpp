#include "analysis/limits/structure_limits.h"

#include <algorithm>

#include "analysis/limits/transient_growth.h"

namespace springstab {

StructureLimits::StructureLimits(Structure structure, const StructureLimitsOptions& options,
                                 std::optional<StiffestMode> k0)
    : structure_(std::make_shared<const Structure>(std::move(structure))),
      options_(options),
      k0_(std::move(k0)) {}

const StiffestMode& StructureLimits::k0() {
  if (!k0_)
    k0_ = (options_.certify ? stiffest_mode : estimated_stiffest_mode)(
        structure_->matrices, {.tolerance = options_.k0_tolerance, .seed = options_.seed});
  return *k0_;
}

// Where D' does not commute with K', or one of them is not symmetric, the matrices themselves decide.
GeneralDamping* StructureLimits::general() {
  const auto& [matrices, damping, every_pose] = *structure_;
  if (damping.kind != DampingModel::Kind::general && matrices.symmetric) return nullptr;
  if (!k0().converged) return nullptr;
  if (!general_)
    general_ = std::make_unique<GeneralDamping>(matrices, k0(), damping, options_.safety, options_.certify,
                                                ArpackOptions{.seed = options_.seed});
  return general_.get();
}

const MethodLimits& StructureLimits::limits(const Method& method) {
  auto known = known_.find(method);
  if (known == known_.end()) known = known_.emplace(method, compute(method)).first;
  return known->second;
}

MethodLimits StructureLimits::compute(const Method& method) {
  GeneralDamping* const general = this->general();
  MethodLimits limits =
      general ? general->limits(method) : method_limits(method, k0(), structure_->damping, options_.safety);
  if (limits.status == LimitStatus::unlimited) limits.recommended = options_.max_step;
  if (!options_.certify) return limits;
  if (structure_->every_pose)
    if (std::optional<HalfPlane> condition = stability_region(method).exact_condition()) {
      condition->x = std::max(condition->x, 0.0);  // damping that helps may be absent in some pose
      limits.every_pose = proved_limit(*structure_->every_pose, *condition, {.seed = options_.seed});
    }
  if (!general) add_transient_growth(method, limits);
  return limits;
}

// With the modes' own damping, or that fitted to the step.
void StructureLimits::add_transient_growth(const Method& method, MethodLimits& limits) {
  const DampingModel& damping = structure_->damping;
  if (!limits.recommended || damping.kind == DampingModel::Kind::general) return;
  const double h = *limits.recommended;
  const double alpha = damping.kind == DampingModel::Kind::designed
                           ? designed_alpha(stability_region(method), h, damping.d0)
                           : damping.alpha;
  limits.transient_growth =
      transient_growth(method, {k0().smallest.value_or(0), k0().value, damping.d0, alpha}, h);
}

std::optional<double> StructureLimits::growth() {
  GeneralDamping* const general = this->general();
  return general ? general->growth() : std::nullopt;
}

}  // namespace springstab
