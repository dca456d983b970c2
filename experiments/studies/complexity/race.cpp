#include "experiments/studies/complexity/race.h"
#include "analysis/method.h"

#include <algorithm>
#include <stdexcept>

#include "experiments/runs/step_run.h"

namespace springstab {
namespace {

SimulateOptions options_for(const Heat& heat, const std::string& method, double duration) {
  SimulateOptions options;
  options.method = method;
  options.duration = duration;
  options.relinearize = heat.interval;
  if (Method(method).info().implicit) options.step = heat.interval;
  return options;
}

void set_damping(Subject& subject, const Heat& heat, const CommonOptions& common) {
  if (heat.contestant.damping == DampingRule::drag) subject.set_alpha(0);
  if (heat.contestant.damping == DampingRule::leu) {
    const SimulateOptions leu_options = options_for(heat, "linearized-explicit-euler", heat.duration);
    StepChooser(subject, step_options(common, leu_options)).first_plan(heat.k0);
  }
}

// The result of one run; only cpu_seconds differs from one to the next.
HeatResult run(const Heat& heat, double duration, const CommonOptions& common) {
  Subject subject(describe(heat.drape));
  subject.scene()->set_hessian(Hessian::projected);
  subject.scene()->solver().preconditioner = heat.contestant.preconditioner;
  subject.scene()->solver().tolerance = heat.contestant.cg_tolerance;
  set_damping(subject, heat, common);
  const SimulateOptions options = options_for(heat, heat.contestant.method, duration);
  StepChooser chooser(subject, step_options(common, options));
  const std::optional<StepPlan> plan = chooser.first_plan(heat.k0);
  if (!plan) throw std::runtime_error(heat.contestant.name + ": " + reason_text(chooser));
  const State<Vector> start = subject.initial_state(common.seed);
  const MethodInfo& method = Method(heat.contestant.method).info();
  if (method.implicit || method.linearized) {  // finds where the blocks are: set-up, not part of the run
    Linearization<Vector> linear;
    subject.system().linearize(start.x, start.v, linear);
  }
  const MeasuredRun measured = measured_run(subject.system(), heat.contestant.method, *plan,
                                            chooser.watch(start), start, {}, chooser.policy());
  HeatResult result;
  result.heat = heat;
  result.h = chooser.decisions().h;
  result.alpha = subject.damping().alpha;
  result.steps = measured.result.steps;
  result.counts = measured.counts;
  result.rollbacks = chooser.decisions().rollbacks;
  result.halved_steps = chooser.decisions().halved_steps;
  result.finished = measured.result.status == StepStatus::done && measured.end.x.allFinite();
  result.cpu_seconds = {measured.cpu_seconds};
  return result;
}

Json json_of(const HeatResult& r) {
  return {{"h", r.h},
          {"alpha", r.alpha},
          {"steps", r.steps},
          {"counts", json_of(r.counts)},
          {"rollbacks", r.rollbacks},
          {"halved_steps", r.halved_steps},
          {"finished", r.finished},
          {"cpu_seconds", r.cpu_seconds}};
}

HeatResult result_of(const Heat& heat, const Json& r) {
  return {heat,
          r.at("h"),
          r.at("alpha"),
          r.at("steps"),
          counts_of(r.at("counts")),
          r.at("rollbacks"),
          r.at("halved_steps"),
          r.at("finished"),
          r.at("cpu_seconds")};
}

bool same(const Counts& a, const Counts& b) {
  return a.force_evaluations == b.force_evaluations && a.hessian_assemblies == b.hessian_assemblies &&
         a.block_products == b.block_products && a.cg_iterations == b.cg_iterations;
}

}  // namespace

StiffestMode k0_of(const Drape& drape, const CommonOptions& common) {
  Subject subject(describe(drape));
  const StiffestMode k0 =
      estimated_stiffest_mode(subject.structure(subject.initial_state(common.seed)).matrices,
                              {.tolerance = 1e-8, .seed = common.seed});
  if (!k0.converged) throw std::runtime_error("k0 of a drape did not converge");
  return k0;
}

double HeatResult::median_seconds() const {
  std::vector<double> sorted = cpu_seconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
}

std::vector<HeatResult> race(const std::vector<Heat>& heats, int rounds, const CommonOptions& common,
                             const std::function<void(double)>& update, Journal& journal) {
  if (!journal.has_next(heats.size() * static_cast<std::size_t>(rounds)))
    for (const Heat& heat : heats) run(heat, heat.duration / 20, common);
  std::vector<HeatResult> results;
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < heats.size(); ++i) {
      const Heat& heat = heats[i];
      const HeatResult one =
          result_of(heat, journal.piece(text("%s on %dx%d, round %d", heat.contestant.name.c_str(),
                                             heat.drape.side, heat.drape.side, round + 1),
                                        [&] { return json_of(run(heat, heat.duration, common)); }));
      if (round == 0) {
        results.push_back(one);
      } else if (same(one.counts, results[i].counts) && one.steps == results[i].steps) {
        results[i].cpu_seconds.push_back(one.cpu_seconds[0]);
      } else {
        throw std::logic_error(heat.contestant.name + " took other counts in another round");
      }
      if (update) update((round + static_cast<double>(i + 1) / static_cast<double>(heats.size())) / rounds);
    }
  return results;
}

}  // namespace springstab
