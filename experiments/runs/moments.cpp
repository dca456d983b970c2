#include "experiments/runs/moments.h"

#include "experiments/command/output.h"
#include "experiments/runs/measured_run.h"

namespace springstab {

MomentsOfRun moments_of(Subject& subject, StepChooser& chooser, const StepPlan& plan, double duration,
                        int count, const CommonOptions& common) {
  const State<Vector> start = subject.initial_state(common.seed);
  const std::unique_ptr<ContactFilter> contact = subject.contact_filter();
  EnergyWatch watch = chooser.watch(start);
  if (subject.contact()) watch = with_obstacles(watch, *subject.contact());
  std::vector<Moment> moments;
  const auto due = [&] { return duration * static_cast<double>(moments.size()) / count * (1 - 1e-9); };
  Progress progress("simulating", common.quiet);
  const MeasuredRun run = measured_run(
      subject.system(), chooser.method().name(), plan, watch, start,
      [&](const SimulationResult& so_far, const State<Vector>& state) {
        while (!moments.empty() && so_far.time < moments.back().time) moments.pop_back();  // undone
        if (so_far.time >= due()) moments.push_back({so_far.time, state});
        progress.update(so_far.time / duration);
        return true;
      },
      chooser.policy(), contact.get(), due);
  const bool done =
      run.result.status == StepStatus::done && moments.size() == static_cast<std::size_t>(count) + 1;
  return {std::move(moments), run.result.time, run.result.status, done};
}

}  // namespace springstab
