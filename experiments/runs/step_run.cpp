#include "experiments/runs/step_run.h"

namespace springstab {

StepOptions step_options(const CommonOptions& common, const SimulateOptions& options) {
  return {.method = options.method,
          .duration = options.duration,
          .step = options.step,
          .max_step = options.max_step,
          .safety = options.safety,
          .relinearize = options.relinearize,
          .seed = common.seed};
}

std::string reason_text(const StepChooser& chooser) {
  switch (chooser.reason()) {
    case NoStep::none_stable:
      return "no positive step of " + chooser.method().name() +
             " is stable with this damping; choose another method (see springstab limits) or "
             "--damping designed";
    case NoStep::not_known:
      return "the stable step of " + chooser.method().name() + " is not known for this damping; give --step";
    case NoStep::k0_not_converged:
      break;
  }
  return "k0 did not converge";
}

Json kept(const StepChooser& chooser, const Model& model) {
  const StepDecisions& d = chooser.decisions();
  return {{"h", d.h},
          {"alpha", model.damping().alpha},
          {"relinearize", d.relinearize},
          {"rollbacks", d.rollbacks},
          {"halved_steps", d.halved_steps},
          {"failures_in_a_row", d.failures_in_a_row},
          {"steps_at_last_failure", d.steps_at_last_failure}};
}

void go_on(StepChooser& chooser, const Json& kept) {
  chooser.go_on({.h = kept.at("h"),
                 .relinearize = kept.at("relinearize"),
                 .rollbacks = kept.at("rollbacks"),
                 .halved_steps = kept.at("halved_steps"),
                 .failures_in_a_row = kept.at("failures_in_a_row"),
                 .steps_at_last_failure = kept.at("steps_at_last_failure")},
                kept.at("alpha"));
}

}  // namespace springstab
