// Uses both installed libraries from outside: (a) the limits of a scene of its own, (b) the region and the
// limits of a method of its own, (c) a force of its own in a simulation.
#include <iostream>

#include "analysis/model.h"
#include "analysis/regions/stability_region.h"
#include "analysis/structure_limits.h"
#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/scene/element_term.h"
#include "solvers/scene/spring_cloth.h"

using namespace springstab;

struct Heun3 {  // of order 3
  MethodInfo info() const { return {"heun3", "Heun 3", 3, false}; }
  template <class V>
  using Steps =
      ExplicitRungeKutta<V, ExplicitTableau<3>{.a = {{{}, {1. / 3}, {0, 2. / 3}}}, .b = {0.25, 0, 0.75}}>;
};

int main() {
  const SpringNet net = make_net(Grid{8, 8}, SpringMaterial{.damping = {0.01, 0.01, 0.01}});
  auto scene =
      std::make_unique<Scene>(net, std::vector<int>{0, 7}, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{});
  const auto towards_rest = [&](int, const Eigen::Vector3d& at) {
    const Eigen::Vector3d pull = 20 * (at - net.rest[63]);
    return ElementEnergy<1>{pull.squaredNorm() / 40, pull, 20 * Eigen::Matrix3d::Identity()};
  };
  scene->add(element_term<1>("tethers", {{63}}, towards_rest));
  Model model(std::move(scene));
  State<Vector> state = model.initial_state();
  StructureLimits answer(model.structure(state));
  const Method mine = make_method(Heun3());
  std::cout << "rk4 " << *answer.limits("rk4").h_max << " s, heun3 " << *answer.limits(mine).h_max
            << " s, its region's y_max " << stability_region(mine).constants().y_max << '\n';
  const StepPlan plan{*answer.limits(mine).recommended, 1000};
  const SimulationResult run =
      simulate(model.system(), *mine.stepper(), plan, model.energy_watch(state), state);
  std::cout << run.time << " s simulated, kinetic energy " << model.system().kinetic_energy(state.v)
            << " J\n";
  return run.status == StepStatus::done ? 0 : 1;
}
