#include "analysis/limits/for_step.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "analysis/constants.h"
#include "analysis/limits/cheapest_method.h"
#include "analysis/limits/split_damping.h"

namespace springstab {
namespace {

constexpr double near_proof = 1e-3;  // of h_max: where the proof is counted on
// Up to as many unknowns all eigenvalues are computed again for each change: those of the generator, or
// of a method's own step.
constexpr Eigen::Index few_unknowns = 48, very_few_unknowns = 18;

// Reasons.
namespace why {
constexpr std::string_view none_stable = "no positive step is stable, however soft or heavy",
                           damping_limits = "damping alone limits the step",
                           no_alpha = "no alpha was found with which it holds",
                           split = "the method takes a part of the damping implicitly",
                           many = "under this damping it is searched for in small systems only",
                           not_symmetric = "K or D is not symmetric", indefinite = "K or D is indefinite",
                           no_condition = "under this damping the method has no exact condition on matrices",
                           designed = "alpha is fitted to the step already", not_proved = "no step is proved",
                           too_many = "they would be more than 1e15";
}  // namespace why

/// > 0 where it holds.
using Slack = std::function<double(double)>;

// The end of what holds between `good` and `bad`, both positive, from the good side, in log x: false position
// with halving where that lags (Illinois).
double border(const Slack& slack, double good, double bad, double tolerance) {
  double a = std::log(good), b = std::log(bad);
  double at_a = slack(good), at_b = slack(bad);
  for (int i = 0; i < 200 && std::abs(b - a) > tolerance; ++i) {
    double t = i % 4 == 3 || !std::isfinite(at_a - at_b) ? 0.5 : at_a / (at_a - at_b);
    t = std::clamp(t, 0.25 * tolerance / std::abs(b - a), 1 - 0.25 * tolerance / std::abs(b - a));
    const double x = a + t * (b - a), at_x = slack(std::exp(x));
    if (at_x >= 0) {
      a = x, at_a = at_x, at_b /= 2;
    } else {
      b = x, at_b = at_x, at_a /= 2;
    }
  }
  return std::exp(a);
}

}  // namespace

// h_max of the structure changed, for one method: exact for modes, else of a StructureLimits of its own.
struct ForStep::Limit {
  Limit(StructureLimits& limits, const Method& m, double wanted)
      : answer(limits), method(m), step(wanted), own(limits.limits(m)) {
    const auto& [matrices, damping, every_pose] = answer.structure();
    const StiffestMode& k0 = answer.k0();
    definite = matrices.symmetric && !k0.indefinite && damping.semidefinite;
    takes_part = springstab::takes_part(method, matrices);
    modal = matrices.symmetric && damping.kind != DampingModel::Kind::general && !takes_part;
    if (definite && !modal && !takes_part && region().matrix_form() != MatrixForm::none)
      condition = region().exact_condition();
    proved = own.h_certified && own.h_max && *own.h_certified >= (1 - near_proof) * *own.h_max;
    tolerance = answer.digits() ? std::pow(10, -*answer.digits()) : 1e-8;
    if (proved && condition) tolerance += 4 * (1 - *own.h_certified / *own.h_max);
  }

  const StabilityRegion& region() const { return stability_region(method); }
  bool searched() const {
    const bool has_function = region().matrix_form() == MatrixForm::stability_function;
    return modal || condition || (takes_part && definite) ||
           answer.structure().matrices.size() <= (has_function ? few_unknowns : very_few_unknowns);
  }

  /// Of modes up to k_max.
  double modal_limit(double k_min, double k_max, double k_lowest, double alpha) const {
    const DampingModel& damping = answer.structure().damping;
    if (damping.kind == DampingModel::Kind::designed)
      return design_damping(region(), k_max, damping.d0).h_max;
    return critical_step(region(), {k_min, k_max, damping.d0, alpha, k_lowest});
  }

  /// The stiffest that is to hold, where the proof is counted on its bound.
  double k_max() const {
    const StiffestMode& k0 = answer.k0();
    const bool near = k0.upper_bound <= (1 + 2 * near_proof) * k0.value;
    return std::max(proved && near ? k0.upper_bound : k0.value, 0.0);
  }

  /// 0 where there is none or it is not known.
  double of(const StructureChange& change) const {
    const StiffestMode k0 = changed(answer.k0(), change);
    const double alpha = change.alpha.value_or(answer.structure().damping.alpha);
    if (modal) {
      const double factor = change.stiffness / change.mass, top = factor * k_max();
      return modal_limit(proved ? 0 : std::clamp(k0.smallest.value_or(0), 0.0, top), top,
                         k0.indefinite ? std::min(k0.lowest.value_or(0), 0.0) : 0, alpha);
    }
    StructureLimits other(changed(answer.structure(), change),
                          {.safety = 1, .certify = false, .digits = answer.digits().value_or(0)}, k0);
    return other.limits(method).h_max.value_or(0);
  }

  /// log(h/H), below 0 also where h is H but for the tolerance.
  double slack(double h) const {
    if (std::isinf(h)) return 1e3;
    return h > 0 ? std::max(std::log(h * (1 - tolerance) / step), -1e3) : -1e3;
  }
  double slack(const StructureChange& change) const { return slack(of(change)); }

  StructureLimits& answer;
  Method method;
  double step;
  const MethodLimits& own;
  bool definite, takes_part, modal, proved;
  double tolerance;  // of h
  std::optional<HalfPlane> condition{};
};

ForStep::ForStep(StructureLimits& answer, double step, int width)
    : answer_(answer), step_(step), width_(width) {
  const Eigen::Index n = answer.structure().matrices.size();
  std::ostringstream message;
  if (!(step > 0 && std::isfinite(step)))
    message << "the wanted step is " << step << " s, expected a positive number of seconds";
  else if (width < 1 || n % width != 0)
    message << width << " unknowns a particle, expected a divisor of " << n;
  if (!message.str().empty()) throw std::invalid_argument(message.str());
}

// A Lyapunov proof is of its own step alone.
StepAnswer ForStep::of(const Method& method) {
  const MethodLimits& limits = answer_.limits(method);
  StepAnswer result;
  result.proved = limits.h_certified && (limits.proof == Proof::lyapunov ? step_ == *limits.h_certified
                                                                         : step_ <= *limits.h_certified);
  if (limits.h_max) result.margin = *limits.h_max / step_;
  if (limits.h_max)
    result.holds = step_ < *limits.h_max || result.proved;
  else if (limits.status == LimitStatus::none || result.proved)
    result.holds = result.proved;
  if (!result.holds) result.unknown = limits.unproved;
  if (result.holds == false) add_changes(Limit(answer_, method, step_), result);
  return result;
}

void ForStep::add_changes(const Limit& limit, StepAnswer& result) const {
  if (limit.searched()) {
    result.stiffness_factor = stiffness_factor(limit);
    result.mass_factor = mass_factor(limit);
    result.alpha = alpha(limit);
  } else {
    result.stiffness_factor = result.mass_factor = why::many;
    result.alpha = why::many;
  }
  result.mass_scaling = mass_scaling(limit);
  result.substeps = substeps(limit.own);
}

namespace {

// The end, nearest to 1, of what holds among 1, r, r², ...; nothing where nothing does down to r^20.
std::optional<double> nearest_to_one(const Slack& slack, double ratio, double tolerance) {
  double bad = 1;
  for (int i = 1; i <= 20; ++i) {
    const double next = std::pow(ratio, i);
    if (slack(next) >= 0) return border(slack, next, bad, tolerance);
    bad = next;
  }
  return std::nullopt;
}

}  // namespace

Found<double> ForStep::stiffness_factor(const Limit& limit) const {
  const auto found = nearest_to_one([&](double s) { return limit.slack(StructureChange{.stiffness = s}); },
                                    0.25, limit.tolerance);
  if (found) return *found;
  return limit.own.status == LimitStatus::none ? why::none_stable : why::damping_limits;
}

Found<double> ForStep::mass_factor(const Limit& limit) const {
  const auto found =
      nearest_to_one([&](double m) { return limit.slack(StructureChange{.mass = m}); }, 4, limit.tolerance);
  if (found) return *found;
  return limit.own.status == LimitStatus::none ? why::none_stable : why::damping_limits;
}

// Of a half-plane: more alpha moves every mode along x, so with x >= 0 an interval from 0, else one to ∞.
Found<AlphaRange> ForStep::alpha_of_condition(const Limit& limit, const HalfPlane& condition) const {
  const auto slack = [&](double alpha) { return limit.slack(StructureChange{.alpha = alpha}); };
  const double top = limit.k_max() * step_, unit = condition.bound / (std::abs(condition.x) * top);
  if (condition.x >= 0) {
    if (slack(0) < 0) return why::no_alpha;
    if (condition.x == 0) return AlphaRange{0, infinity};
    double good = 0, bad = 2 * unit;
    for (double next = unit; good == 0; bad = next, next /= 4)
      if (slack(next) >= 0)
        good = next;
      else if (next < 1e-12 * unit)
        return AlphaRange{0, 0};
    return AlphaRange{0, border(slack, good, bad, limit.tolerance)};
  }
  if (slack(0) >= 0) return AlphaRange{0, infinity};
  double bad = 1e-6 * unit, good = bad;
  while (slack(good) < 0)
    if (bad = good, good *= 4; good > 1e12 * unit) return why::no_alpha;
  return AlphaRange{border(slack, good, bad, limit.tolerance), infinity};
}

// 0, the alpha that is designed for the step, and a grid up to where the stiffest mode, overdamped,
// leaves the real interval R: X = R + Y/R.
std::vector<double> ForStep::alphas(const StabilityRegion& region, double k) const {
  constexpr int samples = 40;
  const double unit = 1 / (step_ * k), y = step_ * step_ * k, r = region.constants().real_interval;
  std::vector<double> grid{0, designed_alpha(region, step_, answer_.structure().damping.d0)};
  for (int i = 1; i <= samples && r > 0; ++i)
    grid.push_back(unit * (std::isfinite(r) ? 1.02 * (r + y / r) * i / samples : std::pow(2.0, i - 10)));
  return grid;
}

// The interval around the alpha that leaves most room.
Found<AlphaRange> ForStep::alpha(const Limit& limit) const {
  const DampingModel& damping = answer_.structure().damping;
  if (damping.kind == DampingModel::Kind::designed) return why::designed;
  if (limit.takes_part) return why::split;
  if (!(limit.k_max() > 0)) return why::no_alpha;
  if (limit.condition) return alpha_of_condition(limit, *limit.condition);
  const auto slack = [&](double alpha) { return limit.slack(StructureChange{.alpha = alpha}); };
  std::vector<double> room, grid = alphas(limit.region(), limit.k_max());
  std::erase_if(grid, [](double alpha) { return !std::isfinite(alpha); });
  std::ranges::sort(grid);
  for (const double alpha : grid) room.push_back(slack(alpha));
  const auto best = std::ranges::max_element(room) - room.begin();
  if (!(room[best] >= 0)) return why::no_alpha;
  auto low = best, high = best;
  while (low > 0 && room[low - 1] >= 0) --low;
  while (high + 1 < std::ssize(grid) && room[high + 1] >= 0) ++high;
  const auto end = [&](auto good, auto bad) {  // 0 has no logarithm
    return border(slack, grid[good], std::max(grid[bad], 1e-9 * grid[good]), limit.tolerance);
  };
  return AlphaRange{low == 0 || grid[low] == 0 ? 0 : end(low, low - 1),
                    high + 1 == std::ssize(grid) ? infinity
                    : grid[high] == 0            ? 0
                                                 : end(high, high + 1)};
}

// Modes: all up to k hold at the step, so M + ΔM is to be such that k (M + ΔM) ≻ K. A half-plane: with d0 of
// the new mass, (c - x H d0) (M + ΔM) ≻ x H (D - d0 M) + y H² K.
Found<MassScaling> ForStep::mass_scaling(const Limit& limit) const {
  const StructuralMatrices& s = answer_.structure().matrices;
  const DampingModel& damping = answer_.structure().damping;
  if (!s.symmetric) return why::not_symmetric;
  if (!limit.definite) return why::indefinite;
  if (limit.takes_part) return why::split;
  if (limit.modal) {
    const double top = limit.k_max();
    const auto slack = [&](double factor) {
      return limit.slack(limit.modal_limit(0, factor * top, 0, damping.alpha));
    };
    const auto factor = nearest_to_one(slack, 0.25, limit.tolerance);
    if (!factor) return limit.own.status == LimitStatus::none ? why::none_stable : why::damping_limits;
    return scale_masses(s.mass, s.stiffness, *factor * top, width_);
  }
  if (!limit.condition) return why::no_condition;
  const auto& [x, y, bound] = *limit.condition;
  const double c = bound - x * step_ * damping.d0;
  if (!(c > 0)) return why::damping_limits;
  const SparseMatrix dampers = s.damping - damping.d0 * s.mass;
  return scale_masses(s.mass, (x * step_) * dampers + (y * step_ * step_) * s.stiffness, c, width_);
}

Found<long> ForStep::substeps(const MethodLimits& limits) const {
  if (!limits.h_certified) return limits.status == LimitStatus::none ? why::none_stable : why::not_proved;
  if (step_ / *limits.h_certified > 1e15) return why::too_many;
  return substeps_of_frame(1 / step_, *limits.h_certified).number;
}

}  // namespace springstab
