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
#include "experiments/limits_report.h"
#include "experiments/stiffest_report.h"
#include "solvers/cpu_time.h"
#include "solvers/io/input_error.h"
#include "solvers/team.h"

namespace springstab {
namespace {

std::vector<std::string> names_of(const std::vector<LimitsRow>& rows) {
  std::vector<std::string> names;
  for (const LimitsRow& row : rows) names.emplace_back(row.method);
  return names;
}

bool nothing_limits(const LimitsRow& row) { return row.limits.status == LimitStatus::unlimited; }

MatricesSize size_of_matrices(const StructuralMatrices& s) {
  return {static_cast<long>(s.size()), static_cast<long>(s.condensed), s.condensed_rate, s.symmetric};
}

// Of a step that stability limits; one that nothing limits is the user's.
void print_too_long(StructureLimits& answer, const std::vector<LimitsRow>& rows, const Subject& subject) {
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

}  // namespace

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

int run_limits(const CommonOptions& common, const LimitsOptions& options) {
  check(common, options);
  const double begin = cpu_seconds();
  const std::vector<Method> methods = methods_of(options);
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
  const std::vector<LimitsRow> rows = rows_of(answer, methods, *waiting);
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
  const MatricesSize size = size_of_matrices(answer.structure().matrices);
  if (common.json) {
    Json json = limits_json(answer, size, rows, options.safety, mesh_json(subject));
    add_size(json, subject);
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
    print_limits(answer, size, rows, options.safety, size_text(subject));
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
