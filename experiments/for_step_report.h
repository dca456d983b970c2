// What `limits` says of a wanted step: --for-step H, or --frame-rate with --substeps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/limits/for_step.h"
#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/limits_options.h"

namespace springstab {

/// Throws InputError for a step or a number of substeps that is none.
void check_for_step(const CommonOptions& common, const LimitsOptions& options);

/// Nothing is said where no step is wanted.
class ForStepReport {
 public:
  ForStepReport(const LimitsOptions& options, StructureLimits& answer, std::span<const Method> methods,
                const Subject& subject, Waiting& waiting);

  /// `for_step`, by the method's name.
  void add_to(Json& json) const;
  void print(std::ostream& out) const;

 private:
  struct Row {
    std::string method;
    StepAnswer answer;
  };
  void print_changes(std::ostream& out) const;

  std::optional<double> step_;  // [s]
  std::vector<Row> rows_;
  std::vector<long> numbers_;  // of the particles, or unknowns, in the input
  const char* particles_;
};

}  // namespace springstab
