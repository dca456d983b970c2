#include "experiments/studies/divergence/examples.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "analysis/limits/step_limits.h"
#include "analysis/regions/amplification.h"
#include "experiments/step_chooser.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/simulation.h"

namespace springstab {
namespace {

constexpr double rod_length = 1, bob_mass = 1, rod_stiffness = 1e4, free_fall = 9.81;  // SI

Scene pendulum(double alpha) {
  const SpringNet net{
      {{0, 0, 0}, {rod_length, 0, 0}}, {bob_mass, bob_mass}, {{0, 1, rod_stiffness, 0, rod_length}}};
  return Scene(net, {0}, {0, -free_fall, 0}, {0, alpha});
}

}  // namespace

Switching switching_oscillator() {
  constexpr double soft = 2.6, stiff = 3.9, beyond = 0.01;
  const auto step = [](double y) { return Method("explicit-euler").amplification(y + beyond, y); };
  const auto radius = [](const Eigen::Matrix2d& a) { return a.eigenvalues().cwiseAbs().maxCoeff(); };
  const Eigen::Matrix2d a = step(soft), b = step(stiff);
  Eigen::Vector2d state{1, 0.7};
  constexpr int periods = 200;
  double logarithm = 0;
  for (int i = 0; i < periods; ++i) {
    state = b * (b * (b * (a * state)));
    logarithm += std::log(state.norm());
    state.normalize();
  }
  return {radius(a), radius(b), std::exp(logarithm / (4 * periods))};
}

Pendulum swinging_pendulum() {
  const StabilityRegion& region = stability_region("linearized-explicit-euler");
  const double k0 = rod_stiffness / bob_mass, safety = 1.5, linearize_every = 0.05, duration = 20;
  const double fitted = design_damping(region, safety * k0, 0).h_max;
  const long each = std::lround(std::ceil(linearize_every / fitted));
  Pendulum result;
  result.step = linearize_every / static_cast<double>(each);
  const double alpha = designed_alpha(region, result.step, 0);
  const long steps = std::lround(duration / result.step);

  const auto run = [&](const char* method, double damping, auto observe) {
    Scene scene = pendulum(damping);
    State<Vector> state = scene.rest_state();
    const EnergyWatch watch = tightened({.gravity = free_fall, .mass = bob_mass});
    return simulate(scene, *Method(method).stepper(), {result.step, steps, each}, watch, state,
                    [&](const SimulationResult& so_far, const State<Vector>& s) {
                      observe(scene, so_far, s);
                      return true;
                    });
  };
  const SimulationResult linearized =
      run("linearized-explicit-euler", alpha, [&](Scene&, const SimulationResult& so_far, const auto& s) {
        result.samples.push_back({so_far.time, s.x.norm(), 0});
      });
  if (linearized.status == StepStatus::diverged) result.exploded_at = linearized.failed_at;
  run("symplectic-euler", 0, [&](Scene& scene, const SimulationResult& so_far, const auto& s) {
    const double energy =
        scene.kinetic_energy(s.v) + scene.potential_energy(s.x) + bob_mass * free_fall * rod_length;
    result.symplectic_largest_energy =
        std::max(result.symplectic_largest_energy, energy / (bob_mass * free_fall * rod_length));
    if (so_far.steps < static_cast<long>(result.samples.size()))
      result.samples[so_far.steps].symplectic = s.x.norm();
  });
  return result;
}

}  // namespace springstab
