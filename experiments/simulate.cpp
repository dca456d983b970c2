// `springstab simulate`: runs a scene or a system of matrices with a step that is known to be stable.
#include <cmath>
#include <iostream>

#include "experiments/command/interrupt.h"
#include "experiments/command/output.h"
#include "experiments/explain.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/runs/checkpoint.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/measured_run.h"
#include "experiments/runs/recorder.h"
#include "experiments/runs/step_run.h"
#include "solvers/io/input_error.h"
#include "solvers/simulation.h"

namespace springstab {
namespace {

constexpr int most_frames = 10'000'000;

void check(const SimulateOptions& options) {
  const auto positive = [](const char* option, double value, const char* unit) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(option, 0, text("is %g, expected a positive number%s", value, unit));
  };
  positive("--duration", options.duration, " of seconds");
  if (options.step) positive("--step", *options.step, " of seconds");
  if (options.max_step) positive("--max-step", *options.max_step, " of seconds");
  positive("--relinearize", options.relinearize, " of seconds");
  if (options.step && options.max_step && *options.step > *options.max_step)
    throw InputError("--step", 0, text("is %g s, expected at most --max-step", *options.step));
  if (!(options.cg_tolerance > 0 && options.cg_tolerance < 1))
    throw InputError("--cg-tolerance", 0,
                     text("is %g, expected more than 0 and less than 1", options.cg_tolerance));
  if (options.frames < 1 || options.frames > most_frames)
    throw InputError("--frames", 0, text("is %d, expected 1 to %d", options.frames, most_frames));
  if (options.resume && options.output.empty()) throw InputError("--resume", 0, needs_output);
}

// All that decides what a run does and writes.
Json identity(const CommonOptions& common, const SimulateOptions& o) {
  if (o.output.empty()) return {};  // nothing is kept
  return identity_of("simulate",
                     {{"method", o.method},
                      {"duration", o.duration},
                      {"step", number(o.step)},
                      {"max-step", number(o.max_step)},
                      {"safety", o.safety},
                      {"relinearize", o.relinearize},
                      {"damping", o.designed_damping ? "designed" : "own"},
                      {"hessian", o.projected_hessian ? "projected" : "exact"},
                      {"solver", o.direct ? "direct" : "cg"},
                      {"cg-tolerance", o.cg_tolerance},
                      {"format", o.format},
                      {"frames", o.frames},
                      {"seed", common.seed}},
                     contents_of(o.input, o.resume));
}

std::string saved(const Recorder& recorder, const CheckpointFile& checkpoint,
                  const SimulateOptions& options) {
  if (options.output.empty()) return "nothing was saved (with --output it would have been)";
  if (checkpoint.saved_until() == 0) return "nothing was saved yet to go on from";
  return text(
      "%d frames and the run up to t = %.6g s are saved in %s; the same command goes on there with --resume",
      recorder.written(), checkpoint.saved_until(), options.output.c_str());
}

const char* outcome(StepStatus status) {
  switch (status) {
    case StepStatus::done:
      return "done";
    case StepStatus::diverged:
      return "diverged";
    case StepStatus::not_positive_definite:
      return "not positive definite";
    case StepStatus::not_converged:
      break;
  }
  return "not converged";
}

// The model as the options want it.
void prepare(Subject& subject, const SimulateOptions& options) {
  if (options.designed_damping) {
    expect_designable(subject);
    subject.design_damping();
  }
  Scene* const scene = subject.scene();
  if (!scene && options.projected_hessian)
    throw InputError("--hessian", 0, "'projected' is for scenes, expected 'exact'");
  if (!scene && options.explain) throw InputError("--explain", 0, "is for scenes, expected no matrices");
  if (options.projected_hessian) scene->set_hessian(Hessian::projected);
}

void prepare_solver(Subject& subject, const SimulateOptions& options) {
  Scene* const scene = subject.scene();
  if (!scene && options.direct)
    throw InputError("--solver", 0, "is for scenes; systems of matrices are always solved directly");
  if (scene)
    scene->solver() = {.kind = options.direct ? SolverKind::cholesky : SolverKind::conjugate_gradients,
                       .tolerance = options.cg_tolerance};
}

int say_no_plan(const StepChooser& chooser, bool json) {
  if (json) {
    print_json(
        Json{{"method", chooser.method().name()}, {"step", nullptr}, {"status", reason_text(chooser)}});
  } else {
    std::cout << reason_text(chooser) << '\n';
  }
  return no_answer;
}

// What a run came to.
struct Course {
  SimulationResult result;
  State<Vector> start, end;
  EnergyWatch watch;
  Counts counts;
  double cpu_seconds = 0, step = 0;
  bool stopped = false;

  bool diverged() const { return result.status == StepStatus::diverged; }
};

// Runs from the start or from where a run was left.
Course run(const CommonOptions& common, const SimulateOptions& options, Subject& subject,
           StepChooser& chooser, const StepPlan& plan, const State<Vector>& start, CheckpointFile& checkpoint,
           const StopOnInterrupt& interrupt, std::optional<Recorder>& recorder) {
  Course course{
      .result = {}, .start = start, .end = {}, .watch = chooser.watch(start), .counts = {}, .step = plan.h};
  KeptRun begin = checkpoint.read().value_or(KeptRun{start_of(plan), start, {}});
  const Json& others = begin.others;
  const bool resumed = !others.is_null();
  if (resumed) go_on(chooser, others.at("chooser"));
  if (resumed && !common.quiet) std::cerr << text("springstab: going on at t = %.6g s\n", begin.run.time);
  recorder.emplace(subject, options, resumed ? others.at("recorder") : Json());
  CountingSystem counted(subject.system(), resumed ? counts_of(others.at("counts")) : Counts());
  const double cpu_before = cpu_seconds() - (resumed ? others.at("cpu_seconds").get<double>() : 0);
  course.end = std::move(begin.state);
  const auto stepper = Method(options.method).stepper();
  if (!resumed) stepper->start(counted, plan.h, course.end);
  Progress progress("simulating", common.quiet);
  course.result = resume_simulation(
      counted, *stepper, std::move(begin.run), course.watch, course.end,
      [&](const RunSoFar& so_far, const State<Vector>& s) {
        recorder->record(so_far.time, s);
        if (so_far.at_checkpoint && (checkpoint.is_due() || interrupt.requested()))
          checkpoint.save({so_far,
                           s,
                           {{"chooser", kept(chooser, subject)},
                            {"recorder", recorder->kept()},
                            {"counts", json_of(counted.counts())},
                            {"cpu_seconds", cpu_seconds() - cpu_before}}});
        if (so_far.steps % 64 == 0) progress.update(so_far.time / options.duration);
        return !interrupt.requested();
      },
      chooser.policy());
  course.cpu_seconds = cpu_seconds() - cpu_before;
  course.counts = counted.counts();
  course.stopped = interrupt.requested();
  return course;
}

Json json_of(const Course& course, const SimulateOptions& options, Subject& subject,
             const StepChooser& chooser, int frames) {
  System& system = subject.system();
  const auto energy = [&](const State<Vector>& s) {
    return number(system.kinetic_energy(s.v) + system.potential_energy(s.x));
  };
  const bool linearized = Method(options.method).info().linearized;
  const StepDecisions& decisions = chooser.decisions();
  Json report{{"method", options.method},
              {"status", course.stopped ? "interrupted" : outcome(course.result.status)},
              {"step", course.step},
              {"steps", course.result.steps},
              {"diverged", course.diverged()},
              {"diverged_at", course.diverged() ? number(course.result.failed_at) : Json()},
              {"grows", course.watch.grows(system.kinetic_energy(course.end.v),
                                           system.potential_energy(course.end.x))},
              {"last_step", decisions.h},
              {"last_relinearize", linearized ? Json(decisions.relinearize) : Json()},
              {"cpu_seconds", course.cpu_seconds},
              {"counts",
               {{"force_evaluations", course.counts.force_evaluations},
                {"hessian_assemblies", course.counts.hessian_assemblies},
                {"block_products", course.counts.block_products},
                {"cg_iterations", course.counts.cg_iterations},
                {"relinearizations", linearized ? course.counts.hessian_assemblies : 0},
                {"rollbacks", decisions.rollbacks},
                {"halved_steps", decisions.halved_steps}}},
              {"energy", {{"initial", energy(course.start)}, {"final", energy(course.end)}}},
              {"frames", frames},
              {"mesh", mesh_json(subject)}};
  report["damping"] = {{"d0", number(subject.damping().d0)}, {"alpha", number(subject.damping().alpha)}};
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d last = scene->positions(course.end.x).back();
    report["last_particle"] = {{"position", {last.x(), last.y(), last.z()}}};
    report["solver"] = options.direct ? "direct" : "cg";
    report["cg_tolerance"] = options.direct ? Json() : Json(options.cg_tolerance);
  }
  return report;
}

void print_end(const Course& course, const SimulateOptions& options) {
  const SimulationResult& result = course.result;
  std::cout << text("%s, %ld steps of %.6g s in %.3g CPU-seconds: ", options.method.c_str(), result.steps,
                    course.step, course.cpu_seconds);
  if (course.stopped) {
    std::cout << text("interrupted at t = %.6g s\n", result.time);
  } else if (course.diverged()) {
    std::cout << text("diverged at t = %.6g s\n", result.failed_at);
  } else if (result.status != StepStatus::done) {
    std::cout << text("stopped at t = %.6g s, the linear system was %s\n", result.time,
                      outcome(result.status));
  } else {
    std::cout << "done\n";
  }
}

void print_decisions(const StepDecisions& decisions, bool linearized) {
  if (decisions.rollbacks > 0)
    std::cout << text("divergence was seen and undone %ld times; the last step was %.6g s%s\n",
                      decisions.rollbacks, decisions.h,
                      linearized ? text(", linearized every %.6g s", decisions.relinearize).c_str() : "");
  if (decisions.halved_steps > 0)
    std::cout << text("%ld steps were halved because 1 + hD' + h²K' was not positive definite\n",
                      decisions.halved_steps);
}

void print_report(const Course& course, const SimulateOptions& options, Subject& subject,
                  const StepChooser& chooser, int frames) {
  System& system = subject.system();
  const auto energy = [&](const State<Vector>& s) {
    return system.kinetic_energy(s.v) + system.potential_energy(s.x);
  };
  print_end(course, options);
  print_decisions(chooser.decisions(), Method(options.method).info().linearized);
  std::cout << text("energy %.6g J at the start, %.6g J at the end\n", energy(course.start),
                    energy(course.end));
  if (course.watch.grows(system.kinetic_energy(course.end.v), system.potential_energy(course.end.x)))
    std::cout << "the structure is unstable: its motion grows by itself\n";
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d p = scene->positions(course.end.x).back();
    std::cout << text("last particle at (%.9g, %.9g, %.9g) m\n", p.x(), p.y(), p.z());
  }
  if (frames > 0) std::cout << text("%d frames in %s\n", frames, options.output.c_str());
}

int run_subject(const CommonOptions& common, const SimulateOptions& options, Subject& subject) {
  prepare(subject, options);
  StepChooser chooser(subject, step_options(common, options));
  const std::optional<StepPlan> plan = chooser.first_plan();
  if (!plan) return say_no_plan(chooser, common.json);
  prepare_solver(subject, options);
  const State<Vector> start = subject.initial_state(common.seed);
  const Json explanation = options.explain ? explain(subject, options.method, *plan, start) : Json();
  if (options.explain && !common.json) std::cout << explanation_table(explanation);
  if (!options.output.empty()) make_folder(options.output);
  CheckpointFile checkpoint(options.output, identity(common, options), options.resume, common.quiet);
  std::optional<Recorder> recorder;
  const StopOnInterrupt interrupt;
  const Course course = run(common, options, subject, chooser, *plan, start, checkpoint, interrupt, recorder);
  if (!course.stopped) recorder->kept();  // a full disk shows before the report

  if (common.json) {
    Json report = json_of(course, options, subject, chooser, recorder->written());
    if (options.explain) report["explanation"] = explanation;
    print_json(report);
  } else {
    print_report(course, options, subject, chooser, recorder->written());
  }
  if (course.stopped) {
    std::cerr << "springstab: interrupted; " << saved(*recorder, checkpoint, options) << '\n';
    return interrupted;
  }
  if (std::cout.flush()) checkpoint.finish();
  recorder->finish();
  if (const std::string earlier = recorder->earlier(); !earlier.empty())
    std::cerr << "springstab: note: " << earlier
              << ": this frame, and those after it, are of an earlier run\n";
  return course.diverged() ? run_diverged : course.result.status == StepStatus::done ? done : no_answer;
}

}  // namespace

int run_simulate(const CommonOptions& common, const SimulateOptions& options) {
  check(options);
  Method{options.method};
  Subject subject(options.input);
  print_mesh_notes(subject);
  return naming_duration([&] { return run_subject(common, options, subject); });
}

}  // namespace springstab
