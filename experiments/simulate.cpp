// `springstab simulate`: runs a scene or a system of matrices with a step that is known to be stable.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "analysis/constants.h"
#include "experiments/command/interrupt.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/contact_report.h"
#include "experiments/explain.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"
#include "experiments/report/pictures.h"
#include "experiments/runs/checkpoint.h"
#include "experiments/runs/contact_steps.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/measured_run.h"
#include "experiments/runs/recorder.h"
#include "experiments/runs/step_run.h"
#include "experiments/simulate_notes.h"
#include "experiments/simulate_report.h"
#include "experiments/simulate_to_error.h"
#include "solvers/io/input_error.h"
#include "solvers/simulation.h"
#include "solvers/team.h"

namespace springstab {
namespace {

constexpr int most_frames = 10'000'000;
constexpr int most_gltf_frames = 1000;  // it has a weight for each two of them
constexpr int most_newton_steps = 100;

void check(const CommonOptions& common, const SimulateOptions& options) {
  const auto positive = [](const char* option, double value, const char* unit) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(option, 0, text("is %g, expected a positive number%s", value, unit));
  };
  positive("--duration", options.duration, " of seconds");
  check_error_options(options, common);
  if (options.step) positive("--step", *options.step, " of seconds");
  if (options.max_step) positive("--max-step", *options.max_step, " of seconds");
  positive("--relinearize", options.relinearize, " of seconds");
  if (options.step && options.max_step && *options.step > *options.max_step)
    throw InputError("--step", 0, text("is %g s, expected at most --max-step", *options.step));
  if (!(options.cg_tolerance > 0 && options.cg_tolerance < 1))
    throw InputError("--cg-tolerance", 0,
                     text("is %g, expected more than 0 and less than 1", options.cg_tolerance));
  if (options.newton < 1 || options.newton > most_newton_steps)
    throw InputError("--newton", 0, text("is %d, expected 1 to %d", options.newton, most_newton_steps));
  if (options.frames < 1 || options.frames > most_frames)
    throw InputError("--frames", 0, text("is %d, expected 1 to %d", options.frames, most_frames));
  if (options.format == "gltf" && options.frames > most_gltf_frames)
    throw InputError("--frames", 0,
                     text("is %d, expected at most %d with --format gltf", options.frames, most_gltf_frames));
  if (options.earlier.resume && options.output.empty()) throw InputError("--resume", 0, needs_output);
  if (options.keep_diverged && options.output.empty())
    throw InputError("--keep-diverged", 0, "needs --output, the folder for the frames");
}

// All that decides what a run does and writes.
Json identity(const CommonOptions& common, const SimulateOptions& o) {
  if (o.output.empty()) return {};  // nothing is kept
  Json settings{{"method", o.method},
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
                {"keep-diverged", o.keep_diverged},
                {"seed", common.seed}};
  if (o.newton != 1) settings["newton"] = o.newton;
  settings.update(method_settings(common));
  return identity_of("simulate", settings, contents_of(o.input, o.earlier.resume));
}

std::string saved(const Recorder& recorder, const CheckpointFile& checkpoint,
                  const SimulateOptions& options) {
  if (options.output.empty()) return "nothing was saved (with --output it would have been)";
  if (checkpoint.saved_until() == 0) return "nothing was saved yet to go on from";
  const std::string same =
      options.error ? text("the same command with --method %s --max-step %.17g in place of --error",
                           options.method.c_str(), options.max_step.value_or(0))
                    : "the same command";
  return text("%d frames and the run up to t = %.6g s are saved in %s; %s goes on there with --resume",
              recorder.written(), checkpoint.saved_until(), options.output.c_str(), same.c_str());
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

int say_no_plan(const std::string& method, const std::string& why, bool json) {
  if (json) {
    print_json(Json{{"method", method.empty() ? Json() : Json(method)}, {"step", nullptr}, {"status", why}});
  } else {
    std::cout << why << '\n';
  }
  return no_answer;
}

// Runs from the start or from where a run was left.
Course run(const CommonOptions& common, const SimulateOptions& options, Subject& subject,
           StepChooser& chooser, StepsInContact& in_contact, const StepPlan& plan, const State<Vector>& start,
           CheckpointFile& checkpoint, const StopOnInterrupt& interrupt, std::optional<Recorder>& recorder,
           Film& film, ErrorRun* error) {
  Course course{
      .result = {}, .start = start, .end = {}, .watch = chooser.watch(start), .counts = {}, .step = plan.h};
  KeptRun begin = checkpoint.read().value_or(KeptRun{start_of(plan), start, {}});
  const Json& others = begin.others;
  const bool resumed = !others.is_null();
  if (resumed) go_on(chooser, others.at("chooser"));
  if (resumed && !common.quiet) std::cerr << text("springstab: going on at t = %.6g s\n", begin.run.time);
  set_loop_threads(common.threads);  // what was measured before is for one
  recorder.emplace(subject, options, resumed ? others.at("recorder") : Json());
  const std::unique_ptr<ContactFilter> contact = subject.contact_filter();
  if (contact && resumed) contact->set_counts(contact_counts_of(others.at("contact")));
  in_contact.follow(contact.get(), chooser);
  if (subject.contact()) course.watch = with_obstacles(course.watch, *subject.contact());
  CountingSystem counted(subject.system(), resumed ? counts_of(others.at("counts")) : Counts());
  const double cpu_before = cpu_seconds() - (resumed ? others.at("cpu_seconds").get<double>() : 0);
  course.end = std::move(begin.state);
  const auto stepper = Method(options.method).stepper();
  if (subject.scene()) stepper->set_newton({.steps = options.newton});
  if (!resumed) stepper->start(counted, plan.h, course.end);
  const bool long_steps = subject.system().size() > many_unknowns;
  Progress progress("simulating", common.quiet);
  course.result = resume_simulation(
      counted, *stepper, std::move(begin.run), course.watch, course.end,
      [&](const RunSoFar& so_far, const State<Vector>& s) {
        recorder->record(so_far.time, s);
        film.see(so_far.time, s.x);
        if (error) error->see(so_far.time, s);
        if (so_far.at_checkpoint && (checkpoint.is_due() || interrupt.requested()))
          checkpoint.save([&]() -> KeptRun {
            Json kept_of_run{{"chooser", kept(chooser, subject)},
                             {"recorder", recorder->kept()},
                             {"counts", json_of(counted.counts())},
                             {"cpu_seconds", cpu_seconds() - cpu_before}};
            if (contact) kept_of_run["contact"] = json_of(contact->counts());
            return {so_far, s, kept_of_run};
          });
        if (long_steps || so_far.at_checkpoint) progress.update(so_far.time / options.duration);
        return !interrupt.requested();
      },
      in_contact.policy(chooser), contact.get(),
      [&] {
        return std::min({recorder->unseen_until(), film.unseen_until(),
                         error ? error->unseen_until() : std::numeric_limits<double>::infinity()});
      });
  if (contact) course.contact = contact->counts();
  course.cpu_seconds = cpu_seconds() - cpu_before;
  course.counts = counted.counts();
  course.stopped = interrupt.requested();
  return course;
}

constexpr int again = -1;  // no exit status

// `error` is null unless an error is to be reached; `again` where the run is to be made once more for it.
int run_subject(const CommonOptions& common, const SimulateOptions& options, Subject& subject,
                ErrorRun* error) {
  const State<Vector> start = subject.initial_state(common.seed);
  StepsInContact in_contact(subject, start, step_options(common, options));
  StepChooser chooser(subject, in_contact.options());
  const std::optional<StepPlan> plan = chooser.first_plan();
  if (!plan) return say_no_plan(options.method, reason_text(chooser), common.json);
  prepare_solver(subject, options);
  print_unused_options(common, options, !subject.scene());
  const Json explanation = options.explain ? explain(subject, options.method, *plan, start) : Json();
  if (options.explain && !common.json) std::cout << explanation_table(explanation);
  print_step_warning(subject, start, plan->h);
  if (!options.output.empty()) make_folder(options.output);
  CheckpointFile checkpoint(options.output, identity(common, options), options.earlier, common.quiet);
  std::optional<Recorder> recorder;
  Film film(options.picture, subject, options.duration);
  const StopOnInterrupt interrupt;
  Course course = run(common, options, subject, chooser, in_contact, *plan, start, checkpoint, interrupt,
                      recorder, film, error);
  if (error && course.result.status == StepStatus::done && !course.stopped) {
    if (error->is_to_repeat(start, chooser.decisions().h, interrupt)) {
      checkpoint.finish();
      return again;
    }
    course.stopped = interrupt.requested();
  }
  if (course.diverged() && options.keep_diverged) {
    checkpoint.finish();  // frames get other numbers: nothing can go on from it
    recorder->record_last();
  }
  if (!course.stopped) {  // a full disk shows before the report
    recorder->flush();
    film.write(course.result.time, course.end.x);
  }

  if (common.json) {
    Json report = json_of(course, options, subject, chooser, recorder->written());
    if (options.keep_diverged) report["diverged_frames"] = recorder->last_steps();
    if (options.explain) report["explanation"] = explanation;
    if (error) report["error"] = error->json();
    print_json(report);
  } else {
    print_report(course, options, subject, chooser, recorder->written());
    if (recorder->last_steps() > 0)
      std::cout << text("the last %d of them are single steps, up to the divergence\n",
                        recorder->last_steps());
    if (error) std::cout << error->text_of();
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
  if (course.diverged()) return run_diverged;
  return course.result.status == StepStatus::done && !(error && error->missed()) ? done : no_answer;
}

int run_to_error(const CommonOptions& common, const SimulateOptions& options, Subject& subject) {
  prepare_solver(subject, options);
  ErrorRun error(common, options, subject);
  if (!error.no_choice().empty()) return say_no_plan("", error.no_choice(), common.json);
  const int status = run_subject(common, error.options(), subject, &error);
  return status == again ? run_subject(common, error.options(), subject, &error) : status;
}

}  // namespace

int run_simulate(const CommonOptions& common, const SimulateOptions& options) {
  check(common, options);
  if (!options.method.empty()) Method{options.method};
  Subject subject(options.input);
  print_mesh_notes(subject);
  print_size_warning(subject);
  if (options.error) expect_no_contact(subject, "--error");
  if (!options.picture.empty()) expect_drawable(options.picture, subject, true);
  prepare(subject, options);
  return naming_duration([&] {
    return options.error ? run_to_error(common, options, subject)
                         : run_subject(common, options, subject, nullptr);
  });
}

}  // namespace springstab
