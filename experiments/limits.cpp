// `springstab limits`: the largest stable step of each method for a structure, and the damping that goes with
// it.
#include <cmath>
#include <iostream>
#include <map>
#include <vector>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/transient_growth.h"
#include "experiments/command/output.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/limits_options.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr double told_growth = 2;

struct Row {
  std::string_view method;
  MethodLimits limits;                 // all unknown if k0 is not
  std::optional<double> h_every_pose;  // proved for every pose [s]
  std::optional<double> growth;        // a lower bound of the largest ‖Aⁿ‖ at the step to use
};

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

const char* name(BoundKind kind) { return kind == BoundKind::inertia ? "inertia" : "gershgorin"; }

// Where every eigenvalue was computed, k0 is one; else it is a Ritz value, from below.
const char* value_kind(const StiffestMode& k0) { return k0.smallest ? "eigenvalue" : "Ritz value"; }

std::optional<double> inertia_bound(const StiffestMode& k0) {
  return k0.bound_kind == BoundKind::inertia ? std::optional(k0.upper_bound) : std::nullopt;
}

std::optional<double> gershgorin_bound(const StiffestMode& k0) {
  return std::isfinite(k0.gershgorin) ? std::optional(k0.gershgorin) : std::nullopt;
}

std::string bounds(const StiffestMode& k0) {
  std::string list;
  if (const auto bound = inertia_bound(k0)) list = text("below %.10g by inertia, ", *bound);
  if (const auto bound = gershgorin_bound(k0)) list += text("at most %.10g by Gershgorin, ", *bound);
  return list.empty() ? "not bounded" : list.substr(0, list.size() - 2);
}

Json k0_json(const StiffestMode& k0) {
  Json json{
      {"value", nullptr},
      {"status", "not converged"},
      {"value_kind", nullptr},
      {"residual", nullptr},
      {"upper_bound", number(k0.upper_bound)},
      {"bound", name(k0.bound_kind)},
      {"bounds", {{"inertia", number(inertia_bound(k0))}, {"gershgorin", number(gershgorin_bound(k0))}}},
      {"products", k0.products},
      {"smallest", number(k0.smallest)}};
  if (!k0.converged) return json;
  json["value"] = number(k0.value);
  json["status"] = "converged";
  json["value_kind"] = value_kind(k0);
  json["residual"] = number(k0.residual);
  return json;
}

const char* name(LimitSource source) { return source == LimitSource::exact ? "exact" : "estimate"; }

const char* name(Proof proof) {
  switch (proof) {
    case Proof::k0_bound:
      return "bound on k0";
    case Proof::quadrant:
      return "whole quadrant";
    case Proof::matrix_condition:
      return "matrix condition";
    case Proof::polygon:
      return "polygon";
    case Proof::lyapunov:
      return "Lyapunov";
    case Proof::none:
      break;
  }
  return "none";
}

Json limits_json(std::string_view method, const MethodLimits& limits, double d0) {
  Json json{{"name", method},
            {"status", name(limits.status)},
            {"h_max", number(limits.h_max)},
            {"h_max_source", limits.h_max ? Json(name(limits.source)) : Json()},
            {"h_certified", number(limits.h_certified)},
            {"h_certified_source", limits.h_certified ? Json(name(limits.proof)) : Json()},
            {"reason", limits.h_certified ? Json() : Json(limits.unproved)},
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
  std::cout << text("\nk0 = %.10g 1/s² (%s, residual %.1g)", k0.value, value_kind(k0), k0.residual);
  std::cout << (k0.value < 0 ? "\n" : text(", 2/√k0 = %.6g s\n", 2 / std::sqrt(k0.value)));
  std::cout << "proved: k0 is " << bounds(k0) << '\n';
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

// The modes' own damping, or that fitted to the step.
std::optional<double> growth_at_recommended(std::string_view method, const MethodLimits& limits,
                                            const StiffestMode& k0, const DampingModel& damping) {
  if (!limits.recommended || damping.kind == DampingModel::Kind::general) return std::nullopt;
  const double h = *limits.recommended;
  const double alpha = damping.kind == DampingModel::Kind::designed
                           ? designed_alpha(stability_region(method), h, damping.d0)
                           : damping.alpha;
  return transient_growth(method, {k0.smallest.value_or(0), k0.value, damping.d0, alpha}, h);
}

// Stable is not decaying from the start.
void print_growth(const std::vector<Row>& rows) {
  std::string list;
  for (const Row& row : rows)
    if (row.growth.value_or(1) >= told_growth)
      list += (list.empty() ? "" : ", ") + std::string(row.method) + text(" %.3g", *row.growth);
  if (!list.empty())
    std::cout << "\nstable at the step to use, but √energy may first grow by a factor of: " << list << '\n';
}

// Why nothing is proved, where the status does not say it.
void print_reasons(const std::vector<Row>& rows) {
  std::map<std::string_view, std::string> methods;
  for (const auto& [method, limits, every_pose, growth] : rows)
    if (!limits.h_certified && limits.status != LimitStatus::none) {
      std::string& list = methods[limits.unproved];
      list += (list.empty() ? "" : ", ") + std::string(method);
    }
  for (const auto& [reason, list] : methods)
    std::cout << '\n' << "not certified, " << reason << ": " << list << '\n';
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
  if (!options.method.empty()) Method{options.method};
  Subject subject(options.input, true);
  print_mesh_notes(subject);
  const StructuralMatrices structure = subject.structure(subject.initial_state(common.seed));
  const StiffestMode k0 = stiffest_mode(structure, {.seed = common.seed});
  const DampingModel damping = subject.damping();

  std::vector<Row> rows;
  const bool general = (damping.kind == DampingModel::Kind::general || !structure.symmetric) && k0.converged;
  std::optional<GeneralDamping> general_damping;
  if (general)
    general_damping.emplace(structure, k0, damping, options.safety, true, ArpackOptions{.seed = common.seed});
  const std::optional<StructuralMatrices> every_pose = subject.every_pose();
  int status = k0.converged ? done : no_answer;
  for (const Method& method : all_methods()) {
    if (!options.method.empty() && method.name() != options.method) continue;
    MethodLimits limits =
        general ? general_damping->limits(method) : method_limits(method, k0, damping, options.safety);
    std::optional<double> h_every_pose;
    if (const auto condition = stability_region(method).exact_condition(); condition && every_pose)
      h_every_pose = proved_limit(*every_pose, *condition, {.seed = common.seed});
    if (limits.status == LimitStatus::unlimited) limits.recommended = options.max_step;
    if (!options.method.empty() && !limits.h_max) status = no_answer;
    if (options.certify && !limits.h_certified) status = no_answer;
    const auto growth = general ? std::nullopt : growth_at_recommended(method, limits, k0, damping);
    rows.push_back({method.name(), limits, h_every_pose, growth});
  }

  const std::optional<double> growth_rate = general ? general_damping->growth() : std::nullopt;

  if (common.json) {
    Json list = Json::array();
    for (const Row& row : rows) {
      list.push_back(limits_json(row.method, row.limits, damping.d0));
      list.back()["h_every_pose"] = number(row.h_every_pose);
      list.back()["transient_growth"] = number(row.growth);
    }
    print_json(Json{{"degrees_of_freedom", structure.size()},
                    {"condensed", structure.condensed},
                    {"k0", k0_json(k0)},
                    {"stiffness_indefinite", k0.indefinite},
                    {"symmetric", structure.symmetric},
                    {"growth_rate", number(growth_rate)},
                    {"damping", damping_json(damping)},
                    {"safety", options.safety},
                    {"mesh", mesh_json(subject)},
                    {"methods", list}});
  } else if (k0.converged) {
    print(structure, k0, damping, options.safety);
    for (const Row& row : rows) print(row.method, row.limits);
    if (!structure.symmetric)
      std::cout
          << "\nK or D is not symmetric: these limits are estimates, from all eigenvalues of the motion\n";
    if (growth_rate.value_or(0) > 0)
      std::cout << text(
          "\nthe motion itself grows, by e in %.4g s (Re μ = %.6g 1/s), whatever the method; limits are "
          "for the other modes\n",
          1 / *growth_rate, *growth_rate);
    print_growth(rows);
    print_reasons(rows);
    for (const Row& row : rows)
      if (row.h_every_pose)
        std::cout << text("\n%s is stable below %.6g s in every pose of these springs: proved\n",
                          std::string(row.method).c_str(), *row.h_every_pose);
  } else {
    std::cout << text("k0 did not converge in %ld products; proved: it is ", k0.products) << bounds(k0)
              << '\n';
  }
  return status;
}

}  // namespace springstab
