// `springstab simulate`: runs a scene or a system of matrices with a step that is known to be stable.
#include <cmath>
#include <csignal>
#include <ctime>
#include <iostream>

#include "analysis/method_limits.h"
#include "experiments/experiments.h"
#include "experiments/frames.h"
#include "experiments/output.h"
#include "solvers/counting.h"
#include "solvers/io/input_error.h"
#include "solvers/simulation.h"

namespace springstab {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

// Ctrl-C ends the run after the current step, while one of these lives.
class StopOnInterrupt {
 public:
  StopOnInterrupt() : previous_(std::signal(SIGINT, [](int) { stop_requested = 1; })) {}
  ~StopOnInterrupt() { std::signal(SIGINT, previous_); }
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  void (*previous_)(int);
};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The step to use and, with designed damping, its alpha. No step where there is none or none is known.
struct StepChoice {
  std::optional<double> step;
  std::string reason;  // where there is no step
};

StepChoice choose_step(Subject& subject, const CommonOptions& common, const SimulateOptions& options) {
  if (options.step) return {*options.step, ""};
  const StructuralMatrices structure = subject.structure();
  const StiffestMode k0 = stiffest_mode(structure, {.seed = common.seed});
  if (!k0.converged) return {std::nullopt, "k0 did not converge"};
  MethodLimits limits = method_limits(options.method, k0, subject.damping(), options.safety);
  if (limits.status == LimitStatus::none)
    return {std::nullopt, "no positive step of " + options.method +
                              " is stable with this damping; choose another method (see springstab limits) or "
                              "--damping designed"};
  if (limits.status == LimitStatus::unknown)
    return {std::nullopt,
            "the stable step of " + options.method + " is not known for this damping; give --step"};
  double step = limits.recommended.value_or(0.01);
  if (options.max_step && (step > *options.max_step || !limits.recommended)) step = *options.max_step;
  return {step, ""};
}

void check(const SimulateOptions& options) {
  const auto positive = [](const char* option, double value, const char* unit) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(option, 0, text("is %g, expected a positive number%s", value, unit));
  };
  positive("--duration", options.duration, " of seconds");
  if (options.step) positive("--step", *options.step, " of seconds");
  if (options.max_step) positive("--max-step", *options.max_step, " of seconds");
  positive("--cg-tolerance", options.cg_tolerance, "");
  if (options.frames < 1) throw InputError("--frames", 0, text("is %d, expected at least 1", options.frames));
}

// Writes evenly spaced frames of a scene, or rows of a CSV file for matrices.
class Recorder {
 public:
  Recorder(Subject& subject, const SimulateOptions& options, long steps, double h)
      : subject_(subject), options_(options), steps_(steps), h_(h) {
    if (options.output.empty()) return;
    make_folder(options.output);
    if (subject.scene()) return;
    csv_.emplace(options.output + "/trajectory.csv");
    csv_->stream() << "t,kinetic_energy,potential_energy";
    for (Eigen::Index i = 0; i < subject.system().size(); ++i) csv_->stream() << ",x" << i + 1;
    csv_->stream() << '\n';
  }

  void record(long step, const State<Vector>& state) {
    // frame f of the last step s where floor(f · steps / frames) = s
    if (options_.output.empty() || step < next_step()) return;
    if (Scene* scene = subject_.scene()) {
      write_frame(options_.output, options_.format, frame_, scene->positions(state.x), subject_.faces());
    } else {
      csv_->stream() << static_cast<double>(step) * h_ << ',' << subject_.system().kinetic_energy(state.v)
                     << ',' << subject_.system().potential_energy(state.x);
      for (double x : state.x) csv_->stream() << ',' << x;
      csv_->stream() << '\n';
    }
    while (next_step() <= step && frame_ <= options_.frames) ++frame_;
    ++written_;
  }

  void finish() {
    if (csv_) csv_->commit();
  }

  int written() const { return written_; }

 private:
  long next_step() const { return static_cast<long>(static_cast<double>(steps_) * frame_ / options_.frames); }

  Subject& subject_;
  const SimulateOptions& options_;
  long steps_;
  double h_;
  std::optional<OutputFile> csv_;
  int frame_ = 0, written_ = 0;
};

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
  find_method(options.method);
  Subject subject(options.input);
  if (options.designed_damping) subject.design_damping();
  const StepChoice choice = choose_step(subject, common, options);
  if (!choice.step) {
    if (common.json) {
      std::cout << Json{{"method", options.method}, {"step", nullptr}, {"status", choice.reason}}.dump(2)
                << '\n';
    } else {
      std::cout << choice.reason << '\n';
    }
    return no_answer;
  }
  const double count = std::max(1.0, std::ceil(options.duration / *choice.step * (1 - 1e-12)));
  if (count > 1e15)
    throw InputError("--step", 0, text("would need %.3g steps, expected at most 1e15", count));
  const long steps = static_cast<long>(count);
  const double h = options.duration / count;
  const DampingModel damping = subject.damping();
  if (damping.kind == DampingModel::Kind::designed)
    subject.set_alpha(designed_alpha(stability_region(options.method), h, damping.d0));
  if (Scene* scene = subject.scene()) scene->solver().tolerance = options.cg_tolerance;

  State<Vector> state = subject.initial_state(common.seed);
  CountingSystem system(subject.system());
  const auto stepper = make_stepper(options.method);
  const EnergyWatch watch = subject.energy_watch(state);
  const double energy_before = system.kinetic_energy(state.v) + system.potential_energy(state.x);
  Recorder recorder(subject, options, steps, h);
  Progress progress("simulating", common.quiet);
  const StopOnInterrupt interrupt_guard;
  const double cpu_start = cpu_seconds();
  const SimulationResult result =
      simulate(system, *stepper, h, steps, watch, state, [&](long step, const State<Vector>& s) {
        recorder.record(step, s);
        if (step % 64 == 0) progress.update(static_cast<double>(step) / count);
        return stop_requested == 0;
      });
  const double cpu = cpu_seconds() - cpu_start;
  recorder.finish();

  const bool diverged = result.status == StepStatus::diverged;
  const Counts& counts = system.counts();
  const double energy_after = system.kinetic_energy(state.v) + system.potential_energy(state.x);
  Json report{{"method", options.method},
              {"status", stop_requested ? "interrupted" : outcome(result.status)},
              {"step", h},
              {"steps", result.steps},
              {"diverged", diverged},
              {"diverged_at", diverged ? number(static_cast<double>(result.steps + 1) * h) : Json()},
              {"cpu_seconds", cpu},
              {"counts",
               {{"force_evaluations", counts.force_evaluations},
                {"hessian_assemblies", counts.hessian_assemblies},
                {"block_products", counts.block_products},
                {"cg_iterations", counts.cg_iterations},
                {"relinearizations", 0},
                {"rollbacks", 0}}},
              {"energy", {{"initial", number(energy_before)}, {"final", number(energy_after)}}},
              {"frames", recorder.written()}};
  report["damping"] = {{"d0", number(subject.damping().d0)}, {"alpha", number(subject.damping().alpha)}};
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d last = scene->positions(state.x).back();
    report["last_particle"] = {{"position", {last.x(), last.y(), last.z()}}};
    report["cg_tolerance"] = options.cg_tolerance;
  }
  if (common.json) {
    std::cout << report.dump(2) << '\n';
  } else {
    std::cout << text("%s, %ld steps of %.6g s in %.3g CPU-seconds: ", options.method.c_str(), result.steps,
                      h, cpu);
    if (stop_requested) {
      std::cout << text("interrupted at t = %.6g s\n", result.time);
    } else if (diverged) {
      std::cout << text("diverged at t = %.6g s\n", static_cast<double>(result.steps + 1) * h);
    } else if (result.status != StepStatus::done) {
      std::cout << text("stopped at t = %.6g s, the linear system was %s\n", result.time,
                        outcome(result.status));
    } else {
      std::cout << "done\n";
    }
    std::cout << text("energy %.6g J at the start, %.6g J at the end\n", energy_before, energy_after);
    if (report.contains("last_particle")) {
      const Json& p = report["last_particle"]["position"];
      std::cout << text("last particle at (%.9g, %.9g, %.9g) m\n", p[0].get<double>(), p[1].get<double>(),
                        p[2].get<double>());
    }
    if (recorder.written() > 0)
      std::cout << text("%d frames in %s\n", recorder.written(), options.output.c_str());
  }
  if (stop_requested) {
    std::cerr << text("springstab: interrupted; saved %d frames\n", recorder.written());
    return interrupted;
  }
  return diverged ? run_diverged : result.status == StepStatus::done ? done : no_answer;
}

}  // namespace springstab
