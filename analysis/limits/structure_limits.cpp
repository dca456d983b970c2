#include "analysis/limits/structure_limits.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "analysis/limits/split_damping.h"
#include "analysis/limits/transient_growth.h"

namespace springstab {

StructureLimits::StructureLimits(Structure structure, const StructureLimitsOptions& options,
                                 std::optional<StiffestMode> k0)
    : structure_(std::make_shared<const Structure>(std::move(structure))),
      options_(options),
      k0_(std::move(k0)) {}

StructureLimits::StructureLimits(const DampingModel& damping, const StructureLimitsOptions& options,
                                 const StiffestMode& k0, std::unique_ptr<GeneralDamping> general)
    : StructureLimits(Structure{{}, damping}, options, k0) {
  general_ = std::move(general);
}

std::optional<int> StructureLimits::digits() const {
  if (options_.digits > 0) return options_.digits;
  return structure_->matrices.size() < many_unknowns ? std::nullopt : std::optional(usual_digits);
}

// h has half the relative error of k0, which is below the residual: h is wrong by less than a quarter of its
// last digit's ten.
double search_tolerance(int digits, double tolerance) {
  return digits > 0 ? std::max(tolerance, 5 * std::pow(10, -digits)) : tolerance;
}

ArpackOptions StructureLimits::search(double tolerance) const {
  return {.tolerance = search_tolerance(digits().value_or(0), tolerance),
          .seed = options_.seed,
          .before_product = options_.before_product};
}

const StiffestMode& StructureLimits::k0() {
  if (k0_) return *k0_;
  const ArpackOptions options = search(options_.k0_tolerance);
  const StructuralMatrices& s = structure_->matrices;
  k0_ = options_.certify ? stiffest_mode(s, options, 2 * options_.certify_loss)
                         : estimated_stiffest_mode(s, options);
  if (!options_.certify && options_.definiteness) find_lowest(s, options, *k0_);
  return *k0_;
}

// Where D' does not commute with K', or one of them is not symmetric, the matrices themselves decide.
GeneralDamping* StructureLimits::general() {
  const auto& [matrices, damping, every_pose] = *structure_;
  if (damping.kind != DampingModel::Kind::general && matrices.symmetric) return nullptr;
  if (!k0().converged) return nullptr;
  if (!general_)
    general_ = std::make_unique<GeneralDamping>(matrices, k0(), damping, options_.safety, options_.certify,
                                                search(ArpackOptions().tolerance));
  return general_.get();
}

const MethodLimits& StructureLimits::limits(const Method& method) {
  auto known = known_.find(method);
  if (known == known_.end()) known = known_.emplace(method, compute(method)).first;
  return known->second;
}

// An exact condition is sharp where it is proved; of others' edges some follow from it.
void StructureLimits::expect(std::span<const Method> methods) {
  if (!options_.certify || !general()) return;
  for (const Method& method : methods)
    if (!takes_part(method, structure_->matrices) && stability_region(method).exact_condition())
      limits(method);
}

// Alpha is fitted mode by mode, which a part of the damping is not: with such a method it is 0.
DampingModel StructureLimits::damping_with(const Method& method) const {
  const auto& [matrices, damping, every_pose] = *structure_;
  if (damping.kind != DampingModel::Kind::designed || !takes_part(method, matrices)) return damping;
  return {DampingModel::Kind::rayleigh, damping.d0, 0};
}

// Rayleigh's damping commutes with K' and M; what a method takes of it implicitly need not.
GeneralDamping* StructureLimits::split(const Method& method) {
  const StructuralMatrices& matrices = structure_->matrices;
  if (!takes_part(method, matrices) || !k0().converged) return nullptr;
  const DampingModel damping = damping_with(method);
  if (!with_damping_) {
    with_damping_ = matrices;
    if (!matrices.has_damping())
      with_damping_->damping = damping.d0 * matrices.mass + damping.alpha * matrices.stiffness;
  }
  if (!splits_damping(method, *with_damping_)) return nullptr;
  if (!split_)
    split_ = std::make_unique<GeneralDamping>(
        *with_damping_, k0(), DampingModel{DampingModel::Kind::general, damping.d0, damping.alpha},
        options_.safety, options_.certify, ArpackOptions{.seed = options_.seed});
  return split_.get();
}

MethodLimits StructureLimits::compute(const Method& method) {
  GeneralDamping* general = this->general();
  if (!general) general = split(method);
  MethodLimits limits =
      general ? general->limits(method) : method_limits(method, k0(), damping_with(method), options_.safety);
  if (takes_part(method, structure_->matrices)) limits.designed.reset();
  if (limits.status == LimitStatus::unlimited && options_.max_step)
    limits.recommended = std::min(limits.recommended.value_or(infinity), *options_.max_step);
  if (!options_.certify) return limits;
  if (structure_->every_pose)
    if (std::optional<HalfPlane> condition = matrix_condition(method, structure_->matrices)) {
      condition->x = std::max(condition->x, 0.0);  // damping that helps may be absent in some pose
      limits.every_pose =
          proved_limit(structure_->every_pose(), *condition, search(ArpackOptions().tolerance));
    }
  if (!general) add_transient_growth(method, limits);
  return limits;
}

// With the modes' own damping, or that fitted to the step.
void StructureLimits::add_transient_growth(const Method& method, MethodLimits& limits) {
  const DampingModel damping = damping_with(method);
  if (!limits.recommended || damping.kind == DampingModel::Kind::general) return;
  const double h = *limits.recommended;
  const double alpha =
      damping.kind == DampingModel::Kind::designed ? designed_alpha(method, h, damping.d0) : damping.alpha;
  limits.transient_growth =
      transient_growth(method, {k0().smallest.value_or(0), k0().value, damping.d0, alpha}, h);
}

std::optional<double> StructureLimits::growth() {
  if (GeneralDamping* const general = this->general()) return general->growth();
  const std::vector<DampedMode> modes = growing_modes();
  return modes.empty() ? std::nullopt : std::optional(modes.front().mu.real());
}

// Of d = d0 + alpha k the softest k grows fastest: k = -μ(μ + d0)/(1 + alpha μ) falls with μ.
std::vector<DampedMode> StructureLimits::growing_modes() {
  const auto& [matrices, damping, every_pose] = *structure_;
  if (general() && matrices.symmetric && growth().value_or(0) > 0) {
    std::vector<DampedMode> modes = damped_modes(matrices).value_or(std::vector<DampedMode>());
    std::erase_if(modes, [](const DampedMode& mode) { return !(mode.mu.real() > 0); });
    return modes;
  }
  if (general() || damping.kind == DampingModel::Kind::designed || !k0().indefinite || !k0().lowest)
    return {};
  const double k = *k0().lowest, d = damping.d0 + damping.alpha * k;
  const double root = std::hypot(d, 2 * std::sqrt(-k));
  return {{d > 0 ? -2 * k / (d + root) : (root - d) / 2, d, k}};
}

}  // namespace springstab
