#include "experiments/studies/contact/contact_study.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/limits/method_limits.h"
#include "analysis/spectra/spectrum.h"
#include "solvers/contact/contact_filter.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab {
namespace {

constexpr double diverged_at = 1e3;  // times the energy of the start

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) {
    return a + (b - a) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double log_uniform(double a, double b) { return std::pow(10, uniform(a, b)); }
  int whole(int least, int most) { return least + static_cast<int>(uniform(0, most - least + 1)); }
  Eigen::Vector3d place() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }

 private:
  std::mt19937_64 engine_;
};

// Springs a tenth longer than at rest, between masses over three decades, the first of which is held.
SpringNet random_net(Random& random, bool chain) {
  SpringNet net;
  const int n = random.whole(4, 12);
  for (int i = 0; i < n; ++i) {
    net.rest.push_back(random.place());
    net.mass.push_back(random.log_uniform(-2, 1));
  }
  const auto join = [&](int i, int j) {
    const double length = (net.rest[i] - net.rest[j]).norm();
    net.springs.push_back({i, j, random.log_uniform(0, 4), 0, length / 1.1});
  };
  for (int j = 1; j < n; ++j) {
    join(chain ? j - 1 : random.whole(0, j - 1), j);
    if (!chain && j > 1) join(random.whole(0, j - 1), j);
  }
  return net;
}

StructuralMatrices structure_of_run(const std::string& structure, Random& random) {
  if (structure == "cloth") {
    const SpringNet net = make_net(Grid{random.whole(4, 7), random.whole(4, 7)}, SpringMaterial{});
    Scene scene(net, {0}, {0, 0, 0}, {});
    State<Vector> state = scene.rest_state();
    state.x *= 1.01;  // about the particle that is held
    const auto linear = scene.linearization(state);
    return prepare(linear->stiffness().to_sparse(), lumped_mass(linear->mass()));
  }
  const SpringNet net = random_net(random, structure == "chains");
  Scene scene(net, {0}, {0, 0, 0}, {});
  const auto linear = scene.linearization(scene.rest_state());
  return prepare(linear->stiffness().to_sparse(), lumped_mass(linear->mass()));
}

// In the space of displacements, which all masses share: each has its own walls, and all alike.
Contact random_walls(Random& random, const ContactModel& model) {
  Contact contact;
  const int walls = random.whole(1, 4);
  for (int k = 0; k < walls; ++k) {
    const Eigen::Vector3d normal = random.place().normalized();
    const double distance = random.uniform(0, 1) < 0.5 ? 0 : random.log_uniform(-3, 0);
    contact.obstacles.push_back({Plane{-distance * normal, normal}});
  }
  contact.model = model;
  return contact;
}

}  // namespace

WalledRuns run_between_walls(const WalledRuns& what, int count, long steps) {
  WalledRuns all = what;
  for (int seed = 1; seed <= count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    MatrixSystem system(structure_of_run(what.structure, random));
    const StructuralMatrices& s = system.matrices();
    const double limit = method_limits(what.method, stiffest_mode(s), {}, 1).h_max.value();
    std::vector<double> mass;
    for (Eigen::Index i = 0; i < s.size(); i += 3) mass.push_back(s.mass.coeff(i, i));
    const auto filter = make_contact_filter(random_walls(random, what.model), mass);
    State<Vector> state{Vector::Zero(s.size()), Vector(s.size())};
    for (double& v : state.v) v = random.uniform(-1, 1);
    const double first = system.kinetic_energy(state.v);
    double largest = 0;
    const EnergyWatch watch{.initial_energy = first, .slack = 1e30};
    const SimulationResult result = simulate(
        system, *what.method.stepper(), {what.part * limit, steps}, watch, state,
        [&](const RunSoFar& run, const State<Vector>& now) {
          if (run.steps % 16 == 0)
            largest = std::max(largest, system.kinetic_energy(now.v) + system.potential_energy(now.x));
          return largest <= diverged_at * first;
        },
        {}, filter.get());
    const bool diverges = result.status != StepStatus::done || largest > diverged_at * first;
    ++all.runs;
    all.diverged += diverges;
    if (!diverges) all.largest_energy = std::max(all.largest_energy, largest / first);
  }
  return all;
}

}  // namespace springstab
