// What the command says of the step policy, and how it keeps its decisions.
#pragma once

#include <string>

#include "analysis/limits/step_policy.h"
#include "experiments/command/output.h"
#include "experiments/simulate_options.h"
#include "solvers/io/input_error.h"

namespace springstab {

StepOptions step_options(const CommonOptions& common, const SimulateOptions& options);

/// Why there is no plan, and what one could do.
std::string reason_text(const StepChooser& chooser);

/// What chooser and model have come to, and a chooser that has planned the same first step brought there.
Json kept(const StepChooser& chooser, const Model& model);
void go_on(StepChooser& chooser, const Json& kept);

/// Names the option of a run that would take too many steps.
template <class Run>
auto naming_duration(const Run& run) {
  try {
    return run();
  } catch (const TooManySteps& error) {
    throw InputError("--duration", 0, error.what());
  }
}

}  // namespace springstab
