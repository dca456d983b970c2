// `springstab limits`: the largest stable step of each method for a structure, and the damping that goes with
// it.
#include <cmath>
#include <iostream>

#include "analysis/general_damping.h"
#include "experiments/experiments.h"
#include "experiments/output.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

const char* name(LimitStatus status) {
  switch (status) {
    case LimitStatus::limited:
      return "limited";
    case LimitStatus::unlimited:
      return "unlimited";
    case LimitStatus::none:
      return "none";
    case LimitStatus::unknown:
      break;
  }
  return "unknown";
}

const char* name(DampingModel::Kind kind) {
  switch (kind) {
    case DampingModel::Kind::none:
      return "none";
    case DampingModel::Kind::rayleigh:
    case DampingModel::Kind::designed:
      return "rayleigh";
    case DampingModel::Kind::general:
      break;
  }
  return "general";
}

Json damping_json(const DampingModel& damping) {
  Json json{{"kind", name(damping.kind)}};
  if (damping.kind == DampingModel::Kind::general) return json;
  json["d0"] = number(damping.d0);
  json["alpha"] = damping.kind == DampingModel::Kind::designed ? Json("designed") : number(damping.alpha);
  return json;
}

Json k0_json(const StiffestMode& k0) {
  if (!k0.converged)
    return {{"value", nullptr},
            {"status", "not converged"},
            {"upper_bound", number(k0.upper_bound)},
            {"residual", nullptr},
            {"products", k0.products}};
  return {{"value", number(k0.value)},
          {"status", "converged"},
          {"upper_bound", number(k0.upper_bound)},
          {"bound", k0.bound_kind == BoundKind::inertia ? "inertia" : "gershgorin"},
          {"residual", number(k0.residual)},
          {"products", k0.products},
          {"smallest", number(k0.smallest)}};
}

const char* name(LimitSource source) { return source == LimitSource::exact ? "exact" : "estimate"; }

Json limits_json(std::string_view method, const MethodLimits& limits, double d0) {
  Json json{{"name", method},
            {"status", name(limits.status)},
            {"h_max", number(limits.h_max)},
            {"h_max_source", limits.h_max ? Json(name(limits.source)) : Json()},
            {"h_certified", number(limits.h_certified)},
            {"recommended_step", number(limits.recommended)},
            {"designed", nullptr}};
  if (limits.designed)
    json["designed"] = {
        {"h_max", number(limits.designed->h_max > 0 ? std::optional(limits.designed->h_max) : std::nullopt)},
        {"alpha", number(limits.designed->alpha)},
        {"d0", number(d0)}};
  return json;
}

std::string cell(const std::optional<double>& h) { return h ? text("%.6g", *h) : "-"; }

void print(const StructuralMatrices& s, const StiffestMode& k0, const DampingModel& damping, double safety) {
  std::cout << text("%ld unknowns", static_cast<long>(s.size()));
  if (s.condensed > 0)
    std::cout << text(" (after eliminating %ld without mass)", static_cast<long>(s.condensed));
  std::cout << text("\nk0 = %.10g 1/s² (proved below %.10g), 2/√k0 = %.6g s\n", k0.value, k0.upper_bound,
                    2 / std::sqrt(k0.value));
  if (k0.indefinite)
    std::cout << "K is indefinite: some motions grow by themselves; limits are for the others\n";
  std::cout << "damping: " << name(damping.kind);
  if (damping.kind == DampingModel::Kind::rayleigh)
    std::cout << text(", d0 = %g 1/s, alpha = %g s", damping.d0, damping.alpha);
  if (damping.kind == DampingModel::Kind::designed)
    std::cout << text(", d0 = %g 1/s, alpha fitted to the step", damping.d0);
  std::cout << text("\n\n%-26s %-10s %12s %12s %14s   %s\n", "method", "status", "h_max [s]", "certified",
                    text("use (F=%g)", safety).c_str(), "with fitted damping: h_max, alpha");
}

void print(std::string_view method, const MethodLimits& l) {
  std::cout << text("%-26s %-10s %12s %12s %14s   ", std::string(method).c_str(), name(l.status),
                    cell(l.h_max).c_str(), cell(l.h_certified).c_str(), cell(l.recommended).c_str());
  std::cout << (l.designed ? text("%.6g, %.4g", l.designed->h_max, l.designed->alpha) : "-") << '\n';
}

}  // namespace

int run_limits(const CommonOptions& common, const LimitsOptions& options) {
  if (!(options.max_step > 0 && std::isfinite(options.max_step)))
    throw InputError("--max-step", 0, text("is %g, expected a positive number of seconds", options.max_step));
  if (!options.method.empty()) find_method(options.method);
  Subject subject(options.input);
  const StructuralMatrices structure = subject.structure(subject.initial_state(common.seed));
  const StiffestMode k0 = stiffest_mode(structure, {.seed = common.seed});
  if (subject.matrices() && k0.indefinite)
    throw InputError(
        options.input.stiffness, 0,
        "the stiffness matrix is indefinite: the structure is unstable by itself, expected a positive "
        "semidefinite one");
  const DampingModel damping = subject.damping();

  struct Row {
    std::string_view method;
    MethodLimits limits;                 // all unknown if k0 is not
    std::optional<double> h_every_pose;  // proved for every pose [s]
  };
  std::vector<Row> rows;
  const bool general = damping.kind == DampingModel::Kind::general && k0.converged;
  std::optional<GeneralDamping> general_damping;
  if (general)
    general_damping.emplace(structure, k0, damping, options.safety, true, ArpackOptions{.seed = common.seed});
  const std::optional<StructuralMatrices> every_pose = subject.every_pose();
  int status = k0.converged ? done : no_answer;
  for (const MethodInfo& info : all_methods()) {
    if (!options.method.empty() && info.name != options.method) continue;
    MethodLimits limits;
    if (k0.converged)
      limits = general ? general_damping->limits(info.name)
                       : method_limits(info.name, k0, damping, options.safety);
    std::optional<double> h_every_pose;
    if (const auto condition = stability_region(info.name).exact_condition(); condition && every_pose)
      h_every_pose = proved_limit(*every_pose, *condition, {.seed = common.seed});
    if (limits.status == LimitStatus::unlimited) limits.recommended = options.max_step;
    if (!options.method.empty() && !limits.h_max) status = no_answer;
    if (options.certify && !limits.h_certified) status = no_answer;
    rows.push_back({info.name, limits, h_every_pose});
  }

  if (common.json) {
    Json list = Json::array();
    for (const Row& row : rows) {
      list.push_back(limits_json(row.method, row.limits, damping.d0));
      list.back()["h_every_pose"] = number(row.h_every_pose);
    }
    std::cout << Json{{"degrees_of_freedom", structure.size()},
                      {"condensed", structure.condensed},
                      {"k0", k0_json(k0)},
                      {"stiffness_indefinite", k0.indefinite},
                      {"damping", damping_json(damping)},
                      {"safety", options.safety},
                      {"methods", list}}
                     .dump(2)
              << '\n';
  } else if (k0.converged) {
    print(structure, k0, damping, options.safety);
    for (const Row& row : rows) print(row.method, row.limits);
    for (const Row& row : rows)
      if (row.h_every_pose)
        std::cout << text("\n%s is stable below %.6g s in every pose of these springs: proved\n",
                          std::string(row.method).c_str(), *row.h_every_pose);
  } else {
    std::cout << text("k0 did not converge in %ld products; it is below %.10g 1/s²\n", k0.products,
                      k0.upper_bound);
  }
  return status;
}

}  // namespace springstab
