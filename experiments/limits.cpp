// `springstab limits`: the largest stable step of each method for a structure, and the damping that goes with
// it.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <vector>

#include "analysis/structure_limits.h"
#include "experiments/cheapest_report.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/contact_report.h"
#include "experiments/for_step_report.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_options.h"
#include "experiments/limits_words.h"
#include "experiments/stiffest_report.h"
#include "solvers/cpu_time.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab {
namespace {

constexpr double told_growth = 2;

struct Row {
  std::string_view method;
  MethodLimits limits;  // all unknown if k0 is not
};

std::vector<std::string> names_of(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) names.emplace_back(row.method);
  return names;
}

bool nothing_limits(const Row& row) { return row.limits.status == LimitStatus::unlimited; }

Json damping_json(const DampingModel& damping) {
  Json json{{"kind", name(damping.kind)}};
  if (damping.kind == DampingModel::Kind::general) return json;
  json["d0"] = number(damping.d0);
  json["alpha"] = damping.kind == DampingModel::Kind::designed ? Json("designed") : number(damping.alpha);
  return json;
}

std::optional<double> factorized_bound(const StiffestMode& k0, BoundKind kind) {
  return k0.bound_kind == kind ? std::optional(k0.upper_bound) : std::nullopt;
}

std::optional<double> gershgorin_bound(const StiffestMode& k0) {
  return std::isfinite(k0.gershgorin) ? std::optional(k0.gershgorin) : std::nullopt;
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

Json limits_json(std::string_view method, const MethodLimits& limits, double d0) {
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

void print(StructureLimits& answer, const std::string& size, double safety) {
  const auto& [s, damping, every_pose] = answer.structure();
  const StiffestMode& k0 = answer.k0();
  std::cout << text("%ld unknowns", static_cast<long>(s.size()));
  if (s.condensed > 0)
    std::cout << text(" (after eliminating %ld without mass", static_cast<long>(s.condensed))
              << (s.condensed_rate > 0 ? text(", whose own motion decays at %.6g 1/s)", s.condensed_rate)
                                       : ")");
  std::cout << (size.empty() ? "" : "\n") << size;
  std::cout << text("\nk0 = %.10g 1/s² (%s, residual %.1g)", k0.value, value_kind(k0), k0.residual);
  std::cout << (k0.value < 0 || !s.symmetric ? "\n" : text(", 2/√k0 = %.6g s\n", 2 / std::sqrt(k0.value)));
  if (const auto digits = answer.digits(); digits && k0.value > 0)
    std::cout << text("searched for %d digits of h: the residual is worth %.1g of it, no bound\n", *digits,
                      k0.residual / k0.value / 2);
  std::cout << "proved: k0 is " << bounds(k0) << '\n';
  if (k0.indefinite) {
    const double rate = answer.growth().value_or(0);
    std::cout << "K is indefinite: some motions grow by themselves"
              << (rate > 0 ? text(", the fastest at %.10g 1/s", rate) : "")
              << "; limits are for the others\n";
  }
  std::cout << "damping: " << name(damping.kind);
  if (damping.kind == DampingModel::Kind::rayleigh)
    std::cout << text(", d0 = %g 1/s, alpha = %g s", damping.d0, damping.alpha);
  if (damping.kind == DampingModel::Kind::designed)
    std::cout << text(", d0 = %g 1/s, alpha fitted to the step", damping.d0);
  std::cout << text("\n\n%-26s %-10s %12s %12s %14s   %s\n", "method", "status", "h_max [s]", "certified",
                    text("use (F=%g)", safety).c_str(), "with fitted damping: h_max, alpha");
}

// Stable is not decaying from the start.
void print_growth(const std::vector<Row>& rows) {
  std::string list;
  for (const Row& row : rows)
    if (const double growth = row.limits.transient_growth.value_or(1); growth >= told_growth)
      list += (list.empty() ? "" : ", ") + std::string(row.method) + text(" %.3g", growth);
  if (!list.empty())
    std::cout << "\nstable at the step to use, but √energy may first grow by a factor of: " << list << '\n';
}

// What a method does of itself, whatever the structure.
void print_method_notes(const std::vector<Row>& rows) {
  std::string amplifying;
  bool verlet = false;
  for (const Row& row : rows) {
    if (amplifies_without_need(row.method))
      amplifying += (amplifying.empty() ? "" : ", ") + std::string(row.method);
    verlet = verlet || row.method == "velocity-verlet";
  }
  if (!amplifying.empty())
    std::cout << "\namplifies with these parameters, undamped motion grows at every step: " << amplifying
              << '\n';
  if (verlet)
    std::cout << "\nvelocity-verlet: each half kick with the damping of its own start. " << leapfrog_words
              << '\n';
}

// Why nothing is proved, where the status does not say it.
void print_reasons(const std::vector<Row>& rows) {
  std::map<std::string_view, std::string> methods;
  for (const auto& [method, limits] : rows)
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

void check(const CommonOptions& common, const LimitsOptions& options) {
  if (!(options.certify_loss >= 1e-5 && options.certify_loss < 1))
    throw InputError("--certify-loss", 0,
                     text("is %g, expected at least 1e-5 and less than 1", options.certify_loss));
  if (common.given.contains("--digits") && (options.digits < 1 || options.digits > 10))
    throw InputError("--digits", 0, text("is %d, expected 1 to 10", options.digits));
  if (!(options.max_step > 0 && std::isfinite(options.max_step)))
    throw InputError("--max-step", 0, text("is %g, expected a positive number of seconds", options.max_step));
  if (!options.method.empty() && !options.methods.empty())
    throw InputError("--method, --methods", 0, "are both given, expected one of them");
  check_cheapest(options);
  check_for_step(common, options);
}

Json report(StructureLimits& answer, const std::vector<Row>& rows, double safety, const Subject& subject) {
  const auto& [matrices, damping, every_pose] = answer.structure();
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(limits_json(row.method, row.limits, damping.d0));
  Json json{{"degrees_of_freedom", matrices.size()},
            {"condensed", matrices.condensed},
            {"condensed_rate", matrices.condensed_rate > 0 ? number(matrices.condensed_rate) : Json()},
            {"k0", k0_json(answer.k0(), answer.digits())},
            {"stiffness_indefinite", answer.k0().indefinite},
            {"symmetric", matrices.symmetric},
            {"growth_rate", number(answer.growth())},
            {"damping", damping_json(damping)},
            {"safety", safety},
            {"mesh", mesh_json(subject)},
            {"methods", list}};
  add_size(json, subject);
  return json;
}

// Of a step that stability limits; one that nothing limits is the user's.
void print_too_long(StructureLimits& answer, const std::vector<Row>& rows, const Subject& subject) {
  const auto scales = time_scales(subject, slowest_period(answer.k0()));
  std::map<std::string, std::string> methods;
  for (const auto& [method, limits] : rows) {
    if (limits.status != LimitStatus::limited || !limits.recommended) continue;
    const std::string what = exceeded(*limits.recommended, scales);
    if (!what.empty()) methods[what] += (methods[what].empty() ? "" : ", ") + std::string(method);
  }
  for (const auto& [what, list] : methods)
    std::cerr << "springstab: warning: stable, but too long to follow the motion: the step to use exceeds "
              << what << ": " << list << '\n';
}

void print(StructureLimits& answer, const std::vector<Row>& rows, double safety, const std::string& size) {
  const auto& [matrices, damping, every_pose] = answer.structure();
  const StiffestMode& k0 = answer.k0();
  if (!k0.converged) {
    std::cout << text("k0 did not converge in %ld products; proved: it is ", k0.products) << bounds(k0)
              << '\n';
    return;
  }
  print(answer, size, safety);
  for (const Row& row : rows) print(row.method, row.limits);
  if (!matrices.symmetric)
    std::cout << (answer.growth() ? "\nK or D is not symmetric: these limits are estimates, from all "
                                    "eigenvalues of the motion\n"
                                  : "\nK or D is not symmetric, and not all eigenvalues of the motion were "
                                    "computed: no limit is "
                                    "known\n");
  if (const double rate = answer.growth().value_or(0); rate > 0)
    std::cout << text(
        "\nthe motion itself grows, by e in %.4g s (Re μ = %.6g 1/s), whatever the method; limits are "
        "for the other modes\n",
        1 / rate, rate);
  print_growth(rows);
  print_method_notes(rows);
  print_reasons(rows);
  for (const auto& [method, limits] : rows)
    if (limits.every_pose)
      std::cout << text("\n%s is stable below %.6g s in every pose of these springs: proved\n",
                        std::string(method).c_str(), *limits.every_pose);
}

std::vector<Row> rows_of(StructureLimits& answer, const std::vector<Method>& methods, Waiting& waiting) {
  std::vector<Row> rows;
  for (const Method& method : methods) {
    waiting.now(method.name());
    rows.push_back({method.name(), answer.limits(method)});
  }
  return rows;
}

// What was asked for and is not there is no answer.
int status_of(StructureLimits& answer, const std::vector<Row>& rows, const LimitsOptions& options) {
  const bool missing = std::ranges::any_of(rows, [&](const Row& row) {
    return (!options.method.empty() && !row.limits.h_max) || (options.certify && !row.limits.h_certified);
  });
  return answer.k0().converged && !missing ? done : no_answer;
}

}  // namespace

int run_limits(const CommonOptions& common, const LimitsOptions& options) {
  check(common, options);
  const double begin = cpu_seconds();
  const std::vector<Method> methods =
      options.method.empty() ? methods_of(options.methods) : std::vector<Method>{options.method};
  Subject subject(options.input, true);
  if (options.error) expect_no_contact(subject, "--error");
  print_mesh_notes(subject);
  print_size_warning(subject);
  const State<Vector> start = subject.initial_state(common.seed);
  Structure structure = subject.structure(start);
  structure.every_pose = subject.every_pose();
  StructureLimits answer(std::move(structure), {.safety = options.safety,
                                                .seed = common.seed,
                                                .digits = options.digits,
                                                .certify_loss = options.certify_loss,
                                                .max_step = options.max_step});

  set_loop_threads(common.threads);
  std::optional<Waiting> waiting(std::in_place, "limits", common.quiet);
  waiting->now("k0");
  answer.k0();
  const std::vector<Row> rows = rows_of(answer, methods, *waiting);
  std::optional<ContactLimits> contact;
  if (subject.contact()) contact.emplace(subject, start, names_of(rows), options.safety);
  // Measured, on one thread, and not the same every time: no program gets it unasked.
  set_loop_threads(1);
  const CheapestOptions asked = cheapest_options(options, cpu_seconds() - begin);
  std::optional<CheapestMethod> cheapest;
  if (!common.json || options.error || options.frame_rate) {
    waiting->now("the cheapest method");
    cheapest.emplace(answer, subject, start, methods, asked);
  }
  const ForStepReport wanted(options, answer, methods, subject, *waiting);
  waiting->now("the stiffest mode");
  const StiffestReport stiffest(options, common, answer, subject, start);
  waiting.reset();
  if (common.json) {
    Json json = report(answer, rows, options.safety, subject);
    if (contact) json["contact"] = contact->json();
    if (cheapest) {
      for (std::size_t i = 0; i < rows.size(); ++i)
        add_steps(json["methods"][i], *cheapest, methods[i], rows[i].limits, asked);
      json["cheapest"] = cheapest_json(*cheapest, asked);
    }
    wanted.add_to(json);
    stiffest.add_to(json);
    print_json(json);
  } else {
    print(answer, rows, options.safety, size_text(subject));
    if (contact) std::cout << contact->text_of();
    if (answer.k0().converged) {
      print_cheapest(*cheapest, answer, methods, asked);
      wanted.print();
      stiffest.print();
    }
  }
  print_too_long(answer, rows, subject);
  if (common.given.contains("--max-step") && std::ranges::none_of(rows, nothing_limits))
    std::cerr << "springstab: note: --max-step has no use here: nothing that was asked for is unlimited\n";
  return status_of(answer, rows, options);
}

}  // namespace springstab
