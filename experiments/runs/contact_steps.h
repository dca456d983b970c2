// The steps of a run in contact by springs: planned at the start for the contact that there may be, and anew
// where more surfaces touch at a particle than that.
//
//     StepsInContact contact(subject, start, options);
//     StepChooser chooser(subject, contact.options());
//     const auto filter = subject.contact_filter();
//     contact.follow(filter.get(), chooser);
//     simulate(…, contact.policy(chooser), filter.get());
#pragma once

#include "analysis/limits/step_policy.h"
#include "experiments/inputs/subject.h"

namespace springstab {

class StepsInContact {
 public:
  /// The subject must outlive it, and its damping be as the options have it.
  StepsInContact(Subject& subject, State<Vector> start, StepOptions options);

  /// With no longer step than the contact that is planned for at the start allows.
  const StepOptions& options() const { return options_; }

  /// Asks at each step of the filter, unless it is null, whether the chooser's step still does. Of a run that
  /// goes on, once the filter has its counts and the chooser its decisions.
  void follow(ContactFilter* filter, StepChooser& chooser);
  /// The chooser's policy, but where contact has outgrown the plan.
  StepPolicy policy(StepChooser& chooser);

 private:
  std::optional<double> largest_step(long contacts);

  Subject& subject_;
  State<Vector> start_;
  StepOptions options_;
  bool designed_;
  std::optional<double> outgrown_;  // the step to go on with [s]
};

}  // namespace springstab
