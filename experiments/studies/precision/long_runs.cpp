#include "experiments/studies/precision/long_runs.h"
#include "analysis/method.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "experiments/studies/precision/contest.h"
#include "experiments/studies/precision/scenes.h"

namespace springstab {
namespace {

constexpr int chain_length = 50, periods = 4;

// A mode q'' + d q' + λ q = 0 as a point whose angle grows evenly: q + i (v + q d/2) / ω, turned round.
std::complex<double> phasor(double q, double v, double lambda, double d) {
  const double omega = std::sqrt(lambda - d * d / 4);
  return {q, -(v + q * d / 2) / omega};
}

}  // namespace

EnergyDrift energy_drift(long steps, const CommonOptions& common) {
  EnergyDrift result;
  result.k0 = undamped_net(1, common).k0();
  result.h = 1 / std::sqrt(result.k0);
  Problem problem = undamped_net(result.h * static_cast<double>(steps), common);
  System& system = problem.system();
  problem.scene()->solver().tolerance = 1e-8;
  const State<Vector>& start = problem.start();
  const double kinetic = system.kinetic_energy(start.v), before = kinetic + system.potential_energy(start.x);
  for (const Method& each : all_methods()) {
    EnergyCurve curve;
    curve.name = each.info().title;
    double largest = 0, next = 1;
    const MeasuredRun run = measured_run(
        system, each.name(), {result.h, steps, contest_steps_per_linearization}, problem.watch(), start,
        [&](const SimulationResult& so_far, const State<Vector>& state) {
          const double energy = system.kinetic_energy(state.v) + system.potential_energy(state.x);
          largest = std::max(largest, std::abs(energy - before) / kinetic);
          if (static_cast<double>(so_far.steps) < next) return true;
          curve.time.push_back(so_far.time);
          curve.drift.push_back(largest);
          next = std::max(next + 1, 1.1 * next);
          return true;
        });
    curve.diverged = run.result.status != StepStatus::done;
    result.curves.push_back(std::move(curve));
  }
  return result;
}

std::vector<PhaseCurve> phase_errors(const CommonOptions& common) {
  const double k0 = 4 * std::pow(std::sin(chain_length * std::numbers::pi / (2. * (chain_length + 1))), 2);
  const double alpha = 2 / std::sqrt(k0);
  const double lambda = 4 * std::pow(std::sin(std::numbers::pi / (2. * (chain_length + 1))), 2);
  Vector slow(chain_length), x(chain_length);
  std::mt19937_64 engine(common.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < chain_length; ++i) {
    slow[i] = std::sin((i + 1) * std::numbers::pi / (chain_length + 1));
    x[i] = slow[i] + 0.1 * uniform(engine);
  }
  slow.normalize();
  const double d = alpha * lambda, omega = std::sqrt(lambda - d * d / 4);
  const double duration = periods * 2 * std::numbers::pi / omega;
  Problem problem("slow mode",
                  SpringChain(std::vector<double>(chain_length, 1.),
                              std::vector<double>(chain_length + 1, 1.), {0, alpha}),
                  x, duration, common);
  std::vector<PhaseCurve> curves;
  for (const Contestant& contestant : method_contestants(problem)) {
    PhaseCurve curve{contestant.name, {}, {}};
    for (double h : contestant.settings) {
      if (contestant.limit && h > *contestant.limit) continue;
      if (h * std::sqrt(k0) < 1e-3) break;
      const Attempt attempt = contestant.attempt(h, 10);
      if (attempt.outcome != Outcome::finished) continue;
      const State<Vector>& end =
          attempt.trajectory.back();  // the phase is that of the start, whole periods on
      const auto turned =
          phasor(slow.dot(end.x), slow.dot(end.v), lambda, d) / phasor(slow.dot(x), 0, lambda, d);
      const double degrees = std::abs(std::arg(turned)) * 180 / std::numbers::pi / periods;
      curve.relative_step.push_back(h * std::sqrt(k0));
      curve.degrees.push_back(std::max(degrees, 1e-12));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace springstab
