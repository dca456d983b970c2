#include "analysis/model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace springstab {
namespace {

// What a scene at rest has of elastic energy after 10^12 rounding errors, more than there are steps in a run:
// they walk 10^6 of them away.
double rounding_energy(Scene& scene, Vector x) {
  const double off = 1e6 * std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
  std::mt19937 random(1);
  for (double& coordinate : x) coordinate += random() % 2 == 0 ? off : -off;
  return scene.elastic_energy(x);
}

}  // namespace

Model::Model(std::unique_ptr<Scene> scene, std::optional<State<Vector>> start)
    : damping_(damping_of(*scene)), start_(start ? std::move(start) : scene->rest_state()) {
  system_ = std::move(scene);
}

Model::Model(std::unique_ptr<MatrixSystem> matrices) : damping_(classify_damping(matrices->matrices())) {
  system_ = std::move(matrices);
}

Model::Model(SpringChain chain, const Vector& x)
    : damping_(damping_of(chain)), start_({x, Vector::Zero(x.size())}) {
  system_ = std::make_unique<SpringChain>(std::move(chain));
}

System& Model::system() {
  return std::visit([](auto& system) -> System& { return *system; }, system_);
}

State<Vector> Model::initial_state(std::uint64_t seed) {
  if (start_) return *start_;
  const Eigen::Index n = system().size();
  State<Vector> state{Vector(n), Vector::Zero(n)};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (double& entry : state.x) entry = uniform(random);
  state.x /= std::sqrt(2 * system().kinetic_energy(state.x));  // xᵀMx = 1
  return state;
}

EnergyWatch Model::energy_watch(const State<Vector>& start) {
  EnergyWatch watch;
  const double kinetic = system().kinetic_energy(start.v), potential = system().potential_energy(start.x);
  watch.initial_energy = kinetic + potential;
  if (Scene* scene = this->scene()) {
    watch.initial_energy =
        kinetic + std::max(scene->elastic_energy(start.x), rounding_energy(*scene, start.x));
    watch.gravity = scene->gravity().norm();
    watch.mass = scene->total_free_mass();
  }
  watch.may_grow = matrices() != nullptr;
  watch.initial_total = kinetic + potential;
  return watch;
}

Structure Model::structure(const State<Vector>& state) {
  Structure structure = scene()      ? structure_of(*scene(), state)
                        : matrices() ? Structure{matrices()->matrices(), damping_}
                                     : structure_of(*pointer<SpringChain>());
  structure.damping = damping_;
  return structure;
}

void Model::design_damping() {
  if (matrices() || damping_.kind == DampingModel::Kind::general)
    throw std::invalid_argument("alpha was to be designed, expected Rayleigh damping alone");
  damping_ = {DampingModel::Kind::designed, damping_.d0, 0};
}

void Model::set_alpha(double alpha) {
  const RayleighDamping damping{damping_.d0, alpha};
  if (Scene* scene = this->scene()) {
    scene->set_damping(damping);
    damping_ = damping_of(*scene);
  } else if (SpringChain* chain = pointer<SpringChain>()) {
    chain->set_damping(damping);
    damping_ = damping_of(*chain);
  } else {
    throw std::invalid_argument("alpha was to be set, but D is given as a matrix");
  }
}

}  // namespace springstab
