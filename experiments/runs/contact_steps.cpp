#include "experiments/runs/contact_steps.h"

#include <algorithm>

#include "experiments/contact_report.h"

namespace springstab {
namespace {

constexpr double same_step = 1 - 1e-9;

}  // namespace

StepsInContact::StepsInContact(Subject& subject, State<Vector> start, StepOptions options)
    : subject_(subject),
      start_(std::move(start)),
      options_(std::move(options)),
      designed_(subject.damping().kind == DampingModel::Kind::designed) {
  const long contacts = subject.counts_contacts() ? subject.contacts(start_.x) : 1;
  if (const auto most = largest_step(contacts))
    options_.max_step = std::min(*most, options_.max_step.value_or(*most));
}

// A function of the start and the contacts alone: a run that goes on finds the same.
std::optional<double> StepsInContact::largest_step(long contacts) {
  if (!subject_.contact_bound()) return std::nullopt;
  Structure structure = in_any_contact(subject_.structure(start_), *subject_.contact_bound(contacts));
  if (designed_) structure.damping.kind = DampingModel::Kind::designed;
  return StructureLimits(std::move(structure),
                         {.safety = options_.safety, .certify = false, .seed = options_.seed})
      .limits(options_.method)
      .recommended;
}

void StepsInContact::follow(ContactFilter* filter, StepChooser& chooser) {
  if (!filter || !filter->counts().springs || options_.step) return;
  if (const long contacts = filter->counts().springs->contacts; contacts > 1)
    if (const auto most = largest_step(contacts)) chooser.limit_step(*most);
  filter->plan_for([this, &chooser](long contacts) {
    const auto most = largest_step(contacts);
    if (!most || *most >= chooser.decisions().h * same_step) return true;
    outgrown_ = most;
    return false;
  });
}

StepPolicy StepsInContact::policy(StepChooser& chooser) {
  return [this, &chooser, otherwise = chooser.policy()](const SimulationResult& so_far,
                                                        const State<Vector>& state,
                                                        const StepPlan& failed) -> std::optional<StepPlan> {
    if (!outgrown_) return otherwise(so_far, state, failed);
    chooser.limit_step(*outgrown_);
    outgrown_.reset();
    return chooser.plan_rest(so_far.time);
  };
}

}  // namespace springstab
