// `springstab simulate`: runs a scene or a system of matrices with a step that is known to be stable.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "analysis/limits/method_limits.h"
#include "experiments/command/interrupt.h"
#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/explain.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/runs/checkpoint.h"
#include "experiments/runs/frames.h"
#include "experiments/runs/identity.h"
#include "experiments/runs/measured_run.h"
#include "experiments/step_chooser.h"
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

// Writes evenly spaced frames of a scene, or rows of a CSV file for matrices.
class Recorder {
 public:
  // Goes on after what another one kept(), if that is not null.
  Recorder(Subject& subject, const SimulateOptions& options, const Json& kept)
      : subject_(subject), options_(options) {
    if (!kept.is_null()) {
      for (const Json& frame : kept.at("frames")) frames_.push_back({frame[0], frame[1]});
      due_ = kept.at("due");
      most_ = kept.at("most");
      for (int frame = 0; subject.scene() && frame < written(); ++frame)
        expect_frame(options.output, options.format, frame);
    }
    if (options.output.empty() || subject.scene()) return;
    csv_.emplace(options.output + "/trajectory.csv",
                 kept.is_null() ? 0 : kept.at("csv_bytes").get<std::uintmax_t>());
    if (!kept.is_null()) return;
    csv_->stream() << "t,kinetic_energy,potential_energy";
    for (Eigen::Index i = 0; i < subject.system().size(); ++i) csv_->stream() << ",x" << i + 1;
    csv_->stream() << '\n';
  }

  void record(double t, const State<Vector>& state) {
    if (options_.output.empty()) return;
    while (!frames_.empty() && t < frames_.back().t) {  // a divergence was undone
      due_ = frames_.back().due;
      frames_.pop_back();
    }
    if (t < next_time()) return;
    if (subject_.scene()) {
      write_frame(options_.output, options_.format, written(), subject_.vertices(state.x), subject_.faces());
    } else {
      csv_->stream() << t << ',' << subject_.system().kinetic_energy(state.v) << ','
                     << subject_.system().potential_energy(state.x);
      for (double x : state.x) csv_->stream() << ',' << x;
      csv_->stream() << '\n';
    }
    frames_.push_back({t, due_});
    most_ = std::max(most_, written());
    while (next_time() <= t && due_ <= options_.frames) ++due_;
  }

  // Where it is; what was recorded is in the system's hands by then.
  Json kept() {
    Json frames = Json::array();
    for (const Frame& frame : frames_) frames.push_back({frame.t, frame.due});
    return {{"frames", frames},
            {"due", due_},
            {"most", most_},
            {"csv_bytes", csv_ ? Json(csv_->keep()) : Json()}};
  }

  void finish() {
    if (csv_) csv_->commit();
    for (int frame = written(); frame < most_; ++frame)  // of what was undone and not reached again
      remove_frame(options_.output, options_.format, frame);
  }

  // The first frame beyond this run's that is there, of an earlier one; empty if none is.
  std::string earlier() const {
    if (options_.output.empty() || !subject_.scene()) return {};
    const std::string path = frame_path(options_.output, options_.format, std::max(most_, written()));
    return std::filesystem::exists(path) ? path : std::string();
  }

  int written() const { return static_cast<int>(frames_.size()); }

 private:
  // A hair early: the time of a step is a rounded sum.
  double next_time() const { return options_.duration * due_ / options_.frames * (1 - 1e-9); }

  Subject& subject_;
  const SimulateOptions& options_;
  std::optional<OutputFile> csv_;
  struct Frame {
    double t;  // [s]
    int due;
  };
  std::vector<Frame> frames_;
  int due_ = 0, most_ = 0;
};

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

}  // namespace

int run_simulate(const CommonOptions& common, const SimulateOptions& options) {
  check(options);
  const Method method = options.method;
  Subject subject(options.input);
  print_mesh_notes(subject);
  if (options.designed_damping) subject.design_damping();
  if (options.projected_hessian) {
    if (!subject.scene()) throw InputError("--hessian", 0, "'projected' is for scenes, expected 'exact'");
    subject.scene()->set_hessian(Hessian::projected);
  }
  if (options.explain && !subject.scene())
    throw InputError("--explain", 0, "is for scenes, expected no matrices");
  StepChooser chooser(subject, common, options);
  const std::optional<StepPlan> plan = chooser.first_plan();
  if (!plan) {
    if (common.json) {
      print_json(Json{{"method", options.method}, {"step", nullptr}, {"status", chooser.reason()}});
    } else {
      std::cout << chooser.reason() << '\n';
    }
    return no_answer;
  }
  const double h = plan->h;
  if (options.direct && !subject.scene())
    throw InputError("--solver", 0, "is for scenes; systems of matrices are always solved directly");
  if (Scene* scene = subject.scene())
    scene->solver() = {.kind = options.direct ? SolverKind::cholesky : SolverKind::conjugate_gradients,
                       .tolerance = options.cg_tolerance};

  const State<Vector> start = subject.initial_state(common.seed);
  const Json explanation = options.explain ? explain(subject, options.method, *plan, start) : Json();
  if (options.explain && !common.json) std::cout << explanation_table(explanation);
  System& system = subject.system();
  const EnergyWatch watch = chooser.watch(start);
  if (!options.output.empty()) make_folder(options.output);
  CheckpointFile checkpoint(options.output, identity(common, options), options.resume, common.quiet);
  KeptRun begin = checkpoint.read().value_or(KeptRun{start_of(*plan), start, {}});
  Json& kept = begin.others;
  if (!kept.is_null()) {
    chooser.go_on(kept.at("chooser"));
    if (!common.quiet) std::cerr << text("springstab: going on at t = %.6g s\n", begin.run.time);
  }
  Recorder recorder(subject, options, kept.is_null() ? Json() : kept.at("recorder"));
  CountingSystem counted(system, kept.is_null() ? Counts() : counts_of(kept.at("counts")));
  const double cpu_before = cpu_seconds() - (kept.is_null() ? 0 : kept.at("cpu_seconds").get<double>());
  State<Vector> state = std::move(begin.state);
  Progress progress("simulating", common.quiet);
  const StopOnInterrupt interrupt;
  const SimulationResult result = resume_simulation(
      counted, *method.stepper(), std::move(begin.run), watch, state,
      [&](const RunSoFar& so_far, const State<Vector>& s) {
        recorder.record(so_far.time, s);
        if (so_far.at_checkpoint && (checkpoint.is_due() || interrupt.requested()))
          checkpoint.save({so_far,
                           s,
                           {{"chooser", chooser.kept()},
                            {"recorder", recorder.kept()},
                            {"counts", json_of(counted.counts())},
                            {"cpu_seconds", cpu_seconds() - cpu_before}}});
        if (so_far.steps % 64 == 0) progress.update(so_far.time / options.duration);
        return !interrupt.requested();
      },
      chooser.policy());
  const double cpu = cpu_seconds() - cpu_before;
  const Counts counts = counted.counts();
  const bool stopped = interrupt.requested();
  if (!stopped) recorder.kept();  // a full disk shows before the report

  const bool diverged = result.status == StepStatus::diverged;
  const auto energy = [&](const State<Vector>& s) {
    return system.kinetic_energy(s.v) + system.potential_energy(s.x);
  };
  const double energy_before = energy(start), energy_after = energy(state);
  const bool grows = watch.grows(system.kinetic_energy(state.v), system.potential_energy(state.x));
  Json report{{"method", options.method},
              {"status", stopped ? "interrupted" : outcome(result.status)},
              {"step", h},
              {"steps", result.steps},
              {"diverged", diverged},
              {"diverged_at", diverged ? number(result.failed_at) : Json()},
              {"grows", grows},
              {"last_step", chooser.present_step()},
              {"last_relinearize", method.info().linearized ? Json(chooser.present_relinearize()) : Json()},
              {"cpu_seconds", cpu},
              {"counts",
               {{"force_evaluations", counts.force_evaluations},
                {"hessian_assemblies", counts.hessian_assemblies},
                {"block_products", counts.block_products},
                {"cg_iterations", counts.cg_iterations},
                {"relinearizations", method.info().linearized ? counts.hessian_assemblies : 0},
                {"rollbacks", chooser.rollbacks()},
                {"halved_steps", chooser.halved_steps()}}},
              {"energy", {{"initial", number(energy_before)}, {"final", number(energy_after)}}},
              {"frames", recorder.written()},
              {"mesh", mesh_json(subject)}};
  report["damping"] = {{"d0", number(subject.damping().d0)}, {"alpha", number(subject.damping().alpha)}};
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d last = scene->positions(state.x).back();
    report["last_particle"] = {{"position", {last.x(), last.y(), last.z()}}};
    report["solver"] = options.direct ? "direct" : "cg";
    report["cg_tolerance"] = options.direct ? Json() : Json(options.cg_tolerance);
  }
  if (options.explain) report["explanation"] = explanation;
  if (common.json) {
    print_json(report);
  } else {
    std::cout << text("%s, %ld steps of %.6g s in %.3g CPU-seconds: ", options.method.c_str(), result.steps,
                      h, cpu);
    if (stopped) {
      std::cout << text("interrupted at t = %.6g s\n", result.time);
    } else if (diverged) {
      std::cout << text("diverged at t = %.6g s\n", result.failed_at);
    } else if (result.status != StepStatus::done) {
      std::cout << text("stopped at t = %.6g s, the linear system was %s\n", result.time,
                        outcome(result.status));
    } else {
      std::cout << "done\n";
    }
    if (chooser.rollbacks() > 0)
      std::cout << text("divergence was seen and undone %ld times; the last step was %.6g s%s\n",
                        chooser.rollbacks(), chooser.present_step(),
                        method.info().linearized
                            ? text(", linearized every %.6g s", chooser.present_relinearize()).c_str()
                            : "");
    if (chooser.halved_steps() > 0)
      std::cout << text("%ld steps were halved because 1 + hD' + h²K' was not positive definite\n",
                        chooser.halved_steps());
    std::cout << text("energy %.6g J at the start, %.6g J at the end\n", energy_before, energy_after);
    if (grows) std::cout << "the structure is unstable: its motion grows by itself\n";
    if (report.contains("last_particle")) {
      const Json& p = report["last_particle"]["position"];
      std::cout << text("last particle at (%.9g, %.9g, %.9g) m\n", p[0].get<double>(), p[1].get<double>(),
                        p[2].get<double>());
    }
    if (recorder.written() > 0)
      std::cout << text("%d frames in %s\n", recorder.written(), options.output.c_str());
  }
  if (stopped) {
    std::cerr << "springstab: interrupted; " << saved(recorder, checkpoint, options) << '\n';
    return interrupted;
  }
  if (std::cout.flush()) checkpoint.finish();
  recorder.finish();
  if (const std::string earlier = recorder.earlier(); !earlier.empty())
    std::cerr << "springstab: note: " << earlier
              << ": this frame, and those after it, are of an earlier run\n";
  return diverged ? run_diverged : result.status == StepStatus::done ? done : no_answer;
}

}  // namespace springstab
