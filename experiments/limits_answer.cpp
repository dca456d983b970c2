#include "experiments/limits_answer.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/command/shared_options.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_words.h"
#include "solvers/cpu_time.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab {
namespace {

Json damping_json(const DampingModel& damping) {
  Json json{{"kind", name(damping.kind)}};
  if (damping.kind == DampingModel::Kind::general) return json;
  json["d0"] = number(damping.d0);
  json["alpha"] = damping.kind == DampingModel::Kind::designed ? Json("designed") : number(damping.alpha);
  return json;
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

std::vector<std::string> names_of(const std::vector<Method>& methods) {
  std::vector<std::string> names;
  for (const Method& method : methods) names.push_back(method.name());
  return names;
}

bool nothing_limits(const LimitsRow& row) { return row.limits.status == LimitStatus::unlimited; }

Structure structure_at(Subject& subject, const State<Vector>& start) {
  Structure structure = subject.structure(start);
  structure.every_pose = subject.every_pose();
  return structure;
}

}  // namespace

std::vector<Method> methods_of(const LimitsOptions& options) {
  return options.method.empty() ? methods_of(options.methods) : std::vector<Method>{options.method};
}

void check_limits_options(const CommonOptions& common, const LimitsOptions& options) {
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

LimitsAnswer::LimitsAnswer(const CommonOptions& common, const LimitsOptions& options,
                           std::vector<Method> methods, Subject& subject, bool measured)
    : common_(common),
      options_(options),
      subject_(subject),
      start_(subject.initial_state(common.seed)),
      limits_(structure_at(subject, start_), {.safety = options.safety,
                                              .seed = common.seed,
                                              .digits = options.digits,
                                              .certify_loss = options.certify_loss,
                                              .max_step = options.max_step}),
      methods_(std::move(methods)) {
  const double begin = cpu_seconds();
  set_loop_threads(common.threads);
  Waiting waiting("limits", common.quiet);
  waiting.now("k0");
  limits_.k0();
  for (const Method& method : methods_) {
    waiting.now(method.name());
    rows_.push_back({method, limits_.limits(method)});
  }
  if (subject.contact()) contact_.emplace(subject, start_, names_of(methods_), options.safety);
  set_loop_threads(1);  // what is measured is on one thread
  cheapest_options_ = cheapest_options(options, cpu_seconds() - begin);
  if (measured || options.error || options.frame_rate) {
    waiting.now("the cheapest method");
    cheapest_.emplace(limits_, subject, start_, methods_, cheapest_options_);
  }
  for_step_.emplace(options_, limits_, methods_, subject, waiting);
  waiting.now("the stiffest mode");
  stiffest_.emplace(options_, common, limits_, subject, start_);
}

Json LimitsAnswer::json_of_structure() {
  const auto& [matrices, damping, every_pose] = limits_.structure();
  Json list = Json::array();
  for (const LimitsRow& row : rows_) list.push_back(limits_json(row.method.name(), row.limits, damping.d0));
  Json json{{"degrees_of_freedom", matrices.size()},
            {"condensed", matrices.condensed},
            {"condensed_rate", matrices.condensed_rate > 0 ? number(matrices.condensed_rate) : Json()},
            {"k0", k0_json(limits_.k0(), limits_.digits())},
            {"stiffness_indefinite", limits_.k0().indefinite},
            {"symmetric", matrices.symmetric},
            {"growth_rate", number(limits_.growth())},
            {"damping", damping_json(damping)},
            {"safety", options_.safety},
            {"mesh", mesh_json(subject_)},
            {"methods", list}};
  add_size(json, subject_);
  return json;
}

Json LimitsAnswer::json() {
  Json json = json_of_structure();
  if (contact_) json["contact"] = contact_->json();
  if (options_.error || options_.frame_rate) {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      add_steps(json["methods"][i], *cheapest_, methods_[i], rows_[i].limits, cheapest_options_);
    json["cheapest"] = cheapest_json(*cheapest_, cheapest_options_);
  }
  for_step_->add_to(json);
  stiffest_->add_to(json);
  return json;
}

std::vector<std::string> LimitsAnswer::remarks() {
  const auto scales = time_scales(subject_, slowest_period(limits_.k0()));
  std::map<std::string, std::string> too_long;  // of steps that stability limits; others are the user's
  for (const auto& [method, limits] : rows_) {
    if (limits.status != LimitStatus::limited || !limits.recommended) continue;
    const std::string what = exceeded(*limits.recommended, scales);
    if (!what.empty()) too_long[what] += (too_long[what].empty() ? "" : ", ") + method.name();
  }
  std::vector<std::string> all;
  for (const auto& [what, list] : too_long)
    all.push_back("warning: stable, but too long to follow the motion: the step to use exceeds " + what +
                  ": " + list);
  if (common_.given.contains("--max-step") && std::ranges::none_of(rows_, nothing_limits))
    all.emplace_back("note: --max-step has no use here: nothing that was asked for is unlimited");
  return all;
}

// What was asked for and is not there is no answer.
int LimitsAnswer::status() {
  const bool missing = std::ranges::any_of(rows_, [&](const LimitsRow& row) {
    return (!options_.method.empty() && !row.limits.h_max) || (options_.certify && !row.limits.h_certified);
  });
  return limits_.k0().converged && !missing ? done : no_answer;
}

}  // namespace springstab
