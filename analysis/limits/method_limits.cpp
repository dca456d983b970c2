#include "analysis/limits/method_limits.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "analysis/proofs/definiteness.h"

namespace springstab {
namespace {

double frobenius_product(const SparseMatrix& a, const SparseMatrix& b) { return a.cwiseProduct(b).sum(); }

// S A S with S = 1/√D_ii, or 1/√M_ii where nothing damps: unknowns weigh alike, however light or soft.
StructuralMatrices unit_damping(const StructuralMatrices& s) {
  const Eigen::VectorXd damping = s.damping.diagonal(), mass = s.mass.diagonal();
  const Eigen::VectorXd root = (damping.array() > 0).select(damping, mass).cwiseSqrt().cwiseInverse();
  StructuralMatrices unit;
  unit.stiffness = scaled(s.stiffness, root);
  unit.mass = scaled(s.mass, root);
  unit.damping = scaled(s.damping, root);
  return unit;
}

// Whether no entry is larger than `tolerance` times √(size_i size_j).
bool is_negligible(const SparseMatrix& a, double tolerance, const Eigen::VectorXd& size) {
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (!(std::abs(it.value()) <= tolerance * std::sqrt(size[it.row()]) * std::sqrt(size[j]))) return false;
  return true;
}

// The least-squares fit of D by d0 M + alpha K, scaled so that M and K have unit size.
DampingModel rayleigh_fit(const StructuralMatrices& s) {
  const double m = s.mass.norm(), k = s.stiffness.norm();
  const double mk = k > 0 ? frobenius_product(s.mass, s.stiffness) / (m * k) : 0;
  const Eigen::Matrix2d normal{{1, mk}, {mk, k > 0 ? 1.0 : 0.0}};
  const Eigen::Vector2d right{frobenius_product(s.damping, s.mass) / m,
                              k > 0 ? frobenius_product(s.damping, s.stiffness) / k : 0};
  const Eigen::Vector2d c = normal.fullPivLu().solve(right);
  return {DampingModel::Kind::rayleigh, c[0] / m, k > 0 ? c[1] / k : 0};
}

std::optional<double> positive(double h) { return h > 0 ? std::optional(h) : std::nullopt; }

constexpr std::string_view indefinite_stiffness = "K is indefinite";

LimitStatus status_of(double h) {
  return h == 0 ? LimitStatus::none : std::isinf(h) ? LimitStatus::unlimited : LimitStatus::limited;
}

}  // namespace

DampingModel classify_damping(const StructuralMatrices& s) {
  if (!s.has_damping()) return {};
  if (!s.symmetric) return {DampingModel::Kind::general, 0, 0, false};
  constexpr double tolerance = 1e-12;
  const StructuralMatrices unit = unit_damping(s);
  DampingModel fit = rayleigh_fit(unit);
  const double size = unit.damping.norm();
  if (fit.d0 < 0 && -fit.d0 * unit.mass.norm() <= tolerance * size) fit.d0 = 0;
  if (fit.alpha < 0 && -fit.alpha * unit.stiffness.norm() <= tolerance * size) fit.alpha = 0;
  if (fit.d0 >= 0 && fit.alpha >= 0) {
    const SparseMatrix rest = unit.damping - fit.d0 * unit.mass - fit.alpha * unit.stiffness;
    const Eigen::VectorXd sizes = Eigen::VectorXd(unit.damping.diagonal()).cwiseAbs() +
                                  fit.d0 * Eigen::VectorXd(unit.mass.diagonal()) +
                                  fit.alpha * Eigen::VectorXd(unit.stiffness.diagonal()).cwiseAbs();
    if (is_negligible(rest, tolerance, sizes)) return fit;
  }
  return {DampingModel::Kind::general, 0, 0, is_semidefinite(s.damping, s.mass)};
}

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
    } else if (region.constants().covers_quadrant) {
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

  const RayleighModes modes{std::clamp(k0.smallest.value_or(0), 0.0, k_max), k_max, damping.d0,
                            damping.alpha};
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
