#include "experiments/limits_answer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "experiments/command/shared_options.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/limits_words.h"
#include "solvers/cpu_time.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab {
namespace {

std::vector<std::string> names_of(const std::vector<Method>& methods) {
  std::vector<std::string> names;
  for (const Method& method : methods) names.push_back(method.name());
  return names;
}

bool nothing_limits(const LimitsRow& row) { return row.limits.status == LimitStatus::unlimited; }

MatricesSize size_of(const StructuralMatrices& s) {
  return {static_cast<long>(s.size()), static_cast<long>(s.condensed), s.condensed_rate, s.symmetric};
}

// Of large scenes nothing is kept that only another linearization would need.
Structure structure_at(Subject& subject, const State<Vector>& start) {
  constexpr Eigen::Index large = 1'000'000;  // unknowns
  Structure structure = subject.structure(start);
  if (Scene* const scene = subject.scene(); scene && scene->size() >= large) scene->forget_matrices();
  structure.every_pose = subject.every_pose();
  return structure;
}

}  // namespace

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
  rows_ = rows_of(limits_, methods_, waiting);
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

Json LimitsAnswer::json() {
  Json json = limits_json(limits_, size_of(limits_.structure().matrices), rows_, options_.safety,
                          mesh_json(subject_));
  add_size(json, subject_);
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

std::string LimitsAnswer::text_of() {
  std::ostringstream out;
  print_limits(out, limits_, size_of(limits_.structure().matrices), rows_, options_.safety,
               size_text(subject_));
  if (contact_) out << contact_->text_of();
  if (limits_.k0().converged) {
    print_cheapest(out, *cheapest_, limits_, methods_, cheapest_options_);
    for_step_->print(out);
    stiffest_->print(out);
  }
  return out.str();
}

int LimitsAnswer::status() { return status_of(limits_, rows_, options_); }

}  // namespace springstab
