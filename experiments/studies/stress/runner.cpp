#include "experiments/studies/stress/runner.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "analysis/errors/linear_motion.h"
#include "analysis/gsl/adaptive_integrator.h"
#include "analysis/limits/general_damping.h"
#include "experiments/command/output.h"
#include "experiments/runs/measured_run.h"
#include "experiments/step_chooser.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr double right_error = 0.1;
constexpr double resolution = 100;      // steps a duration, at least
constexpr double most_work = 2e6;       // unknowns times steps, of one run
constexpr double most_seconds = 60;     // CPU, of one run: beyond it hangs
constexpr long bounded_steps = 400000;  // at a multiple of the limit
constexpr double stiff_step = 1e3;      // times 2/√k0, at a multiple of no limit
constexpr double most_reference = 1e8;  // unknowns times force evaluations
constexpr double reference_error = 1e-8;

/// The slowest mode that is not rigid, at its largest displacement, and a quarter of its period [s].
struct SlowMode {
  State<Vector> start;
  double quarter;
};

SlowMode slow_mode(const StructuralMatrices& s) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes{Eigen::MatrixXd(s.stiffness),
                                                                        Eigen::MatrixXd(s.mass)};
  const Vector& k = modes.eigenvalues();
  const double rigid = 1e-13 * k.cwiseAbs().maxCoeff();
  Eigen::Index i = 0;
  while (i + 1 < k.size() && std::abs(k[i]) <= rigid) ++i;
  constexpr double quarter_turn = 1.5707963267948966;
  return {{modes.eigenvectors().col(i), Vector::Zero(k.size())},
          k[i] == 0 ? 1 : quarter_turn / std::sqrt(std::abs(k[i]))};
}

MethodLimits limits_of(Subject& subject, const State<Vector>& start, std::string_view method,
                       const CommonOptions& common, double& k0_value) {
  const StructuralMatrices structure = subject.structure(start);
  const StiffestMode k0 = stiffest_mode(structure, {.seed = common.seed});
  k0_value = k0.value;
  const DampingModel damping = subject.damping();
  if (damping.kind != DampingModel::Kind::general) return method_limits(method, k0, damping, 1);
  return GeneralDamping(structure, k0, damping, 1, false, {.seed = common.seed}).limits(method);
}

double norm(System& system, const Vector& u) { return std::sqrt(2 * system.kinetic_energy(u)); }

std::optional<Vector> true_places(Subject& subject, const State<Vector>& start, double time) {
  if (MatrixSystem* matrices = subject.matrices();
      matrices && subject.damping().kind != DampingModel::Kind::general)
    return LinearMotion(matrices->matrices(), subject.damping().d0, subject.damping().alpha, start)
        .at(time)
        .x;
  System& system = subject.system();
  const double size = std::max(start.x.cwiseAbs().maxCoeff(), 1e-300);
  long evaluations = 0;
  const AdaptiveResult result = integrate_adaptively(
      system, start, {time},
      {.tolerance = reference_error,
       .place_scale = size,
       .velocity_scale = std::max(start.v.cwiseAbs().maxCoeff(), size / time),
       .give_up = [&] { return static_cast<double>(++evaluations * system.size()) > most_reference; }});
  if (!result.finished) return std::nullopt;
  return result.at.back().x;
}

class Run {
 public:
  Run(const StressCase& c, std::string_view method, const CommonOptions& common, Subject& subject,
      std::optional<StiffestMode>& k0, StressResult& result)
      : case_(c), method_(method), common_(common), subject_(subject), k0_(k0), result_(result) {}

  void operator()() {
    choose_start();
    if (case_.ratio && !step_of_ratio()) return;
    StepChooser chooser(subject_, common_, options_);
    if (!k0_) k0_ = chooser.first_k0();
    std::optional<StepPlan> plan = options_.step ? chooser.first_plan() : chooser.first_plan(*k0_);
    if (!plan) return say(StressOutcome::no_step, chooser.reason());
    const long affordable =
        std::max<long>(100, static_cast<long>(most_work / static_cast<double>(subject_.system().size())));
    const bool shortened = plan->steps > affordable;
    if (shortened) plan->steps = affordable;
    result_.step = plan->h;
    double most_kinetic = 0;
    const double before = cpu_seconds();
    bool in_time = true, finite = true;
    System& system = subject_.system();
    const MeasuredRun run = measured_run(
        system, method_, *plan, chooser.watch(start_), start_,
        [&](const SimulationResult&, const State<Vector>& s) {
          finite = finite && s.x.allFinite() && s.v.allFinite();
          most_kinetic = std::max(most_kinetic, system.kinetic_energy(s.v));
          in_time = cpu_seconds() - before < most_seconds;
          return in_time;
        },
        chooser.policy());
    result_.steps = run.result.steps;
    if (!finite || !run.end.x.allFinite()) return say(StressOutcome::wrong, "not a number");
    if (!in_time) return say(StressOutcome::wrong, text("not done after %g CPU-seconds", most_seconds));
    if (run.result.status == StepStatus::diverged)
      return say(StressOutcome::diverges, text("at t = %.3g s", run.result.failed_at));
    if (run.result.status != StepStatus::done)
      return say(StressOutcome::limit, "the linear system was not solved");
    if (case_.ratio) return say(StressOutcome::right, "bounded");
    if (!case_.compared) return judge_energy(run.end);
    judge(run.end, run.result.time,
          shortened
              ? text("a motion of %g s takes %.2g steps", options_.duration, options_.duration / plan->h)
              : "");
  }

 private:
  void say(StressOutcome outcome, const std::string& detail) {
    result_.outcome = outcome;
    result_.detail = detail;
  }

  void choose_start() {
    start_ = subject_.initial_state(common_.seed);
    options_.method = method_;
    options_.duration = case_.duration;
    if (subject_.matrices() && !case_.ratio) {
      const SlowMode slow = slow_mode(subject_.structure(start_));
      start_ = slow.start;
      if (case_.duration == 0) options_.duration = slow.quarter;
    }
    options_.max_step = options_.duration / resolution;
    options_.relinearize = options_.duration / resolution;
  }

  bool step_of_ratio() {
    double k0 = 0;
    const MethodLimits limits = limits_of(subject_, start_, method_, common_, k0);
    if (limits.status == LimitStatus::none || limits.status == LimitStatus::unknown)
      return say(StressOutcome::no_step, "no positive step is stable"), false;
    options_.step = *case_.ratio * (limits.status == LimitStatus::unlimited ? stiff_step * 2 / std::sqrt(k0)
                                                                            : *limits.h_max);
    options_.duration = bounded_steps * *options_.step;
    options_.relinearize = options_.duration;
    return true;
  }

  void judge_energy(const State<Vector>& end) {
    System& system = subject_.system();
    const auto total = [&](const State<Vector>& s) {
      return system.kinetic_energy(s.v) + system.potential_energy(s.x);
    };
    const double gained = total(end) - total(start_);
    const double size = std::max(system.kinetic_energy(end.v), subject_.energy_watch(start_).initial_energy);
    if (gained <= right_error * size) return say(StressOutcome::right, "energy does not grow");
    say(StressOutcome::wrong, text("gained %.3g J of %.3g J", gained, size));
  }

  void judge(const State<Vector>& end, double time, const std::string& limit) {
    const std::optional<Vector> truth = true_places(subject_, start_, time);
    if (!truth) return say(StressOutcome::wrong, "no reference");
    System& system = subject_.system();
    const double size = subject_.matrices() ? norm(system, start_.x) : norm(system, *truth - start_.x);
    const double off = norm(system, end.x - *truth);
    result_.error = off == 0 ? 0 : off / size;
    if (!(*result_.error <= right_error))
      return say(StressOutcome::wrong, text("off by %.3g of the motion", *result_.error));
    if (limit.empty()) return say(StressOutcome::right, "");
    say(StressOutcome::limit, limit);
  }

  const StressCase& case_;
  std::string method_;
  const CommonOptions& common_;
  Subject& subject_;
  std::optional<StiffestMode>& k0_;
  StressResult& result_;
  State<Vector> start_;
  SimulateOptions options_;
};

}  // namespace

StressResult run_stress(const StressCase& c, std::string_view method, const std::string& folder,
                        const CommonOptions& common, std::optional<StiffestMode>& k0) {
  StressResult result{.kind = c.kind,
                      .name = c.name,
                      .method = std::string(method),
                      .expected = c.expected.of(method),
                      .detail = "",
                      .error = {}};
  const auto refused = [&](const std::exception& error) {
    result.outcome = StressOutcome::refused;
    result.detail = error.what();
    for (std::size_t at; (at = result.detail.find(folder + "/")) != std::string::npos;)
      result.detail.erase(at, folder.size() + 1);
  };
  try {
    Subject subject(c.write(folder));
    Run(c, method, common, subject, k0, result)();
  } catch (const InputError& error) {
    refused(error);
  } catch (const std::invalid_argument& error) {
    refused(error);
  } catch (const std::exception& error) {
    result.outcome = StressOutcome::wrong;
    result.detail = std::string("internal error: ") + error.what();
  }
  return result;
}

}  // namespace springstab
