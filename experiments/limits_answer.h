// What `limits` computes of an input, to be told as text, as JSON or as a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/structure_limits.h"
#include "experiments/cheapest_report.h"
#include "experiments/contact_report.h"
#include "experiments/for_step_report.h"
#include "experiments/limits_options.h"
#include "experiments/limits_report.h"
#include "experiments/stiffest_report.h"

namespace springstab {

class LimitsAnswer {
 public:
  /// Computes it all; `subject` must outlive it. The cheapest method is measured, which is not the same every
  /// time: for people, and for programs (JSON) only where they ask for it.
  LimitsAnswer(const CommonOptions& common, const LimitsOptions& options, std::vector<Method> methods,
               Subject& subject, bool measured);
  LimitsAnswer(const LimitsAnswer&) = delete;

  Subject& subject() { return subject_; }
  const State<Vector>& start() const { return start_; }
  StructureLimits& limits() { return limits_; }
  const std::vector<LimitsRow>& rows() const { return rows_; }
  const CheapestMethod* cheapest() const { return cheapest_ ? &*cheapest_ : nullptr; }
  double safety() const { return options_.safety; }

  /// What `limits --json` prints.
  Json json();
  /// What `limits` prints; of a measured one.
  std::string text_of();
  /// What `limits` says on stderr beside it, a line each.
  std::vector<std::string> remarks();
  /// An ExitStatus.
  int status();

 private:
  const CommonOptions& common_;
  LimitsOptions options_;
  Subject& subject_;
  State<Vector> start_;
  StructureLimits limits_;
  std::vector<Method> methods_;
  std::vector<LimitsRow> rows_;
  std::optional<ContactLimits> contact_;
  CheapestOptions cheapest_options_;
  std::optional<CheapestMethod> cheapest_;
  std::optional<ForStepReport> for_step_;
  std::optional<StiffestReport> stiffest_;
};

}  // namespace springstab
