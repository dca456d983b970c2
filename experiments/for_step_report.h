// What `limits` says of a wanted step: --for-step H, or --frame-rate with --substeps.
#pragma once

#include <span>
#include <vector>

#include "analysis/limits/for_step.h"
#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/limits_options.h"

namespace springstab {

/// Throws InputError for a step or a number of substeps that is none.
void check_for_step(const CommonOptions& common, const LimitsOptions& options);

/// [s]; nothing where none is asked for.
std::optional<double> wanted_step(const LimitsOptions& options);

struct MethodAnswer {
  Method method;
  StepAnswer answer;
};

/// By the method's name.
Json for_step_json(std::span<const MethodAnswer> answers, double step, const Subject& subject);
void print_for_step(std::span<const MethodAnswer> answers, double step, const Subject& subject);

}  // namespace springstab
