// What `limits` says of the matrices and the methods, as JSON and as a table.
#include "experiments/limits_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include "experiments/command/shared_options.h"
#include "experiments/limits_words.h"

namespace springstab {
namespace {

constexpr double told_growth = 2;

Json damping_json(const DampingModel& damping) {
  Json json{{"kind", name(damping.kind)}};
  if (damping.kind == DampingModel::Kind::general) return json;
  json["d0"] = number(damping.d0);
  json["alpha"] = damping.kind == DampingModel::Kind::designed ? Json("designed") : number(damping.alpha);
  return json;
}

std::string bounds(const StiffestMode& k0) {
  std::string list;
  for (const BoundKind kind : {BoundKind::inertia, BoundKind::pieces})
    if (const auto bound = factorized_bound(k0, kind)) list = text("below %.10g by %s, ", *bound, name(kind));
  if (const auto bound = gershgorin_bound(k0)) list += text("at most %.10g by Gershgorin, ", *bound);
  return list.empty() ? "not bounded" : list.substr(0, list.size() - 2);
}

Json k0_json(const StiffestMode& k0, std::optional<int> digits) {
  Json json{{"value", nullptr},
            {"status", "not converged"},
            {"value_kind", nullptr},
            {"residual", nullptr},
            {"upper_bound", number(k0.upper_bound)},
            {"bound", name(k0.bound_kind)},
            {"bounds",
             {{"inertia", number(factorized_bound(k0, BoundKind::inertia))},
              {"gershgorin", number(gershgorin_bound(k0))}}},
            {"products", k0.products},
            {"smallest", number(k0.smallest)}};
  if (digits) json["digits"] = *digits;
  if (const auto bound = factorized_bound(k0, BoundKind::pieces)) json["bounds"]["pieces"] = *bound;
  if (!k0.converged) return json;
  json["value"] = number(k0.value);
  json["status"] = "converged";
  json["value_kind"] = value_kind(k0);
  json["residual"] = number(k0.residual);
  return json;
}

Json row_json(std::string_view method, const MethodLimits& limits, double d0) {
  Json json{{"name", method},
            {"status", name(limits.status)},
            {"h_max", number(limits.h_max)},
            {"h_max_source", limits.h_max ? Json(name(limits.source)) : Json()},
            {"h_certified", number(limits.h_certified)},
            {"h_certified_source", limits.h_certified ? Json(name(limits.proof)) : Json()},
            {"reason", limits.h_certified ? Json() : Json(limits.unproved)},
            {"recommended_step", number(limits.recommended)},
            {"designed", nullptr},
            {"h_every_pose", number(limits.every_pose)},
            {"transient_growth", number(limits.transient_growth)}};
  if (limits.designed)
    json["designed"] = {
        {"h_max", number(limits.designed->h_max > 0 ? std::optional(limits.designed->h_max) : std::nullopt)},
        {"alpha", number(limits.designed->alpha)},
        {"d0", number(d0)}};
  return json;
}

std::string cell(const std::optional<double>& h) { return h ? text("%.6g", *h) : "-"; }

void print_matrices(std::ostream& out, StructureLimits& answer, const MatricesSize& s,
                    const std::string& size, double safety) {
  const DampingModel& damping = answer.structure().damping;
  const StiffestMode& k0 = answer.k0();
  out << text("%ld unknowns", s.unknowns);
  if (s.condensed > 0)
    out << text(" (after eliminating %ld without mass", s.condensed)
        << (s.condensed_rate > 0 ? text(", whose own motion decays at %.6g 1/s)", s.condensed_rate) : ")");
  out << (size.empty() ? "" : "\n") << size;
  out << text("\nk0 = %.10g 1/s² (%s, residual %.1g)", k0.value, value_kind(k0), k0.residual);
  out << (k0.value < 0 || !s.symmetric ? "\n" : text(", 2/√k0 = %.6g s\n", 2 / std::sqrt(k0.value)));
  if (const auto digits = answer.digits(); digits && k0.value > 0)
    out << text("searched for %d digits of h: the residual is worth %.1g of it, no bound\n", *digits,
                k0.residual / k0.value / 2);
  out << "proved: k0 is " << bounds(k0) << '\n';
  if (k0.indefinite) {
    const double rate = answer.growth().value_or(0);
    out << "K is indefinite: some motions grow by themselves"
        << (rate > 0 ? text(", the fastest at %.10g 1/s", rate) : "") << "; limits are for the others\n";
  }
  out << "damping: " << name(damping.kind);
  if (damping.kind == DampingModel::Kind::rayleigh)
    out << text(", d0 = %g 1/s, alpha = %g s", damping.d0, damping.alpha);
  if (damping.kind == DampingModel::Kind::designed)
    out << text(", d0 = %g 1/s, alpha fitted to the step", damping.d0);
  out << text("\n\n%-26s %-10s %12s %12s %14s   %s\n", "method", "status", "h_max [s]", "certified",
              text("use (F=%g)", safety).c_str(), "with fitted damping: h_max, alpha");
}

// Stable is not decaying from the start.
void print_growth(std::ostream& out, const std::vector<LimitsRow>& rows) {
  std::string list;
  for (const LimitsRow& row : rows)
    if (const double growth = row.limits.transient_growth.value_or(1); growth >= told_growth)
      list += (list.empty() ? "" : ", ") + row.method.name() + text(" %.3g", growth);
  if (!list.empty())
    out << "\nstable at the step to use, but √energy may first grow by a factor of: " << list << '\n';
}

// What a method does of itself, whatever the structure.
void print_method_notes(std::ostream& out, const std::vector<LimitsRow>& rows) {
  std::string amplifying;
  bool verlet = false;
  for (const LimitsRow& row : rows) {
    if (amplifies_without_need(row.method))
      amplifying += (amplifying.empty() ? "" : ", ") + row.method.name();
    verlet = verlet || row.method.name() == "velocity-verlet";
  }
  if (!amplifying.empty())
    out << "\namplifies with these parameters, undamped motion grows at every step: " << amplifying << '\n';
  if (verlet)
    out << "\nvelocity-verlet: each half kick with the damping of its own start. " << leapfrog_words << '\n';
}

// Why nothing is proved, where the status does not say it.
void print_reasons(std::ostream& out, const std::vector<LimitsRow>& rows) {
  std::map<std::string_view, std::string> methods;
  for (const auto& [method, limits] : rows)
    if (!limits.h_certified && limits.status != LimitStatus::none) {
      std::string& list = methods[limits.unproved];
      list += (list.empty() ? "" : ", ") + method.name();
    }
  for (const auto& [reason, list] : methods)
    out << '\n' << "not certified, " << reason << ": " << list << '\n';
}

void print_row(std::ostream& out, const LimitsRow& row) {
  const auto& [method, l] = row;
  out << text("%-26s %-10s %12s %12s %14s   ", method.name().c_str(), name(l.status), cell(l.h_max).c_str(),
              cell(l.h_certified).c_str(), cell(l.recommended).c_str());
  out << (l.designed ? text("%.6g, %.4g", l.designed->h_max, l.designed->alpha) : "-") << '\n';
}

}  // namespace

std::vector<Method> methods_of(const LimitsOptions& options) {
  if (options.method.empty()) return methods_of(options.methods);
  return {options.method};
}

std::vector<LimitsRow> rows_of(StructureLimits& answer, const std::vector<Method>& methods,
                               Waiting& waiting) {
  std::vector<LimitsRow> rows;
  answer.expect(methods);
  for (const Method& method : methods) {
    waiting.now(method.name());
    rows.push_back({method, answer.limits(method)});
  }
  return rows;
}

// What was asked for and is not there is no answer.
int status_of(StructureLimits& answer, const std::vector<LimitsRow>& rows, const LimitsOptions& options) {
  const bool missing = std::ranges::any_of(rows, [&](const LimitsRow& row) {
    return (!options.method.empty() && !row.limits.h_max) || (options.certify && !row.limits.h_certified);
  });
  return answer.k0().converged && !missing ? done : no_answer;
}

Json limits_json(StructureLimits& answer, const MatricesSize& size, const std::vector<LimitsRow>& rows,
                 double safety, const Json& mesh) {
  const DampingModel& damping = answer.structure().damping;
  Json list = Json::array();
  for (const LimitsRow& row : rows) list.push_back(row_json(row.method.name(), row.limits, damping.d0));
  return {{"degrees_of_freedom", size.unknowns},
          {"condensed", size.condensed},
          {"condensed_rate", size.condensed_rate > 0 ? number(size.condensed_rate) : Json()},
          {"k0", k0_json(answer.k0(), answer.digits())},
          {"stiffness_indefinite", answer.k0().indefinite},
          {"symmetric", size.symmetric},
          {"growth_rate", number(answer.growth())},
          {"damping", damping_json(damping)},
          {"safety", safety},
          {"mesh", mesh},
          {"methods", list}};
}

void print_limits(std::ostream& out, StructureLimits& answer, const MatricesSize& size,
                  const std::vector<LimitsRow>& rows, double safety, const std::string& size_text) {
  const StiffestMode& k0 = answer.k0();
  if (!k0.converged) {
    out << text("k0 did not converge in %ld products; proved: it is ", k0.products) << bounds(k0) << '\n';
    return;
  }
  print_matrices(out, answer, size, size_text, safety);
  for (const LimitsRow& row : rows) print_row(out, row);
  if (!size.symmetric)
    out << (answer.growth() ? "\nK or D is not symmetric: these limits are estimates, from all "
                              "eigenvalues of the motion\n"
                            : "\nK or D is not symmetric, and not all eigenvalues of the motion were "
                              "computed: no limit is "
                              "known\n");
  if (const double rate = answer.growth().value_or(0); rate > 0)
    out << text(
        "\nthe motion itself grows, by e in %.4g s (Re μ = %.6g 1/s), whatever the method; limits are "
        "for the other modes\n",
        1 / rate, rate);
  print_growth(out, rows);
  print_method_notes(out, rows);
  print_reasons(out, rows);
  for (const auto& [method, limits] : rows)
    if (limits.every_pose)
      out << text("\n%s is stable below %.6g s in every pose of these springs: proved\n",
                  method.name().c_str(), *limits.every_pose);
}

}  // namespace springstab
