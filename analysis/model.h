// A system that runs, and what limits, policies and studies need to know about it: a scene, matrices or a
// chain, behind one face.
//
//     Model model(std::make_unique<Scene>(net, pinned, gravity, RayleighDamping{.d0 = 1}));
//     State<Vector> state = model.initial_state();
//     const double h = StructureLimits(model.structure(state)).limits("rk4").recommended.value();
//     simulate(model.system(), *Method("rk4").stepper(), {h, 100}, model.energy_watch(state), state);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "analysis/limits/structure.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/scene.h"
#include "solvers/simulation.h"
#include "solvers/spring_chain.h"

namespace springstab {

class Model {
 public:
  Model() = default;  // nothing yet: only to be assigned to
  /// Starts at rest_state() unless `start` is given.
  explicit Model(std::unique_ptr<Scene> scene, std::optional<State<Vector>> start = std::nullopt);
  /// Starts at rest with a random displacement of unit M-norm.
  explicit Model(std::unique_ptr<MatrixSystem> matrices);
  /// Starts at rest, displaced by x [m].
  Model(SpringChain chain, const Vector& x);

  System& system();
  Scene* scene() const { return pointer<Scene>(); }                   // null unless it is one
  MatrixSystem* matrices() const { return pointer<MatrixSystem>(); }  // null unless it is some
  bool is_linear() const { return !scene(); }

  /// `seed` is for the random start of matrices.
  State<Vector> initial_state(std::uint64_t seed = 1);
  EnergyWatch energy_watch(const State<Vector>& start);

  /// At a state (a linear system is the same at all), without every_pose. A scene is linearized there.
  Structure structure(const State<Vector>& state);
  const DampingModel& damping() const { return damping_; }
  /// Leaves alpha to the design. Throws std::invalid_argument where D is given as a matrix or the scene has
  /// damping of its own.
  void design_damping();
  /// Fixes alpha of a scene's or a chain's Rayleigh damping, also where it was left to the design.
  void set_alpha(double alpha);

 private:
  template <class T>
  T* pointer() const {
    const auto* held = std::get_if<std::unique_ptr<T>>(&system_);
    return held ? held->get() : nullptr;
  }

  std::variant<std::unique_ptr<Scene>, std::unique_ptr<MatrixSystem>, std::unique_ptr<SpringChain>> system_;
  DampingModel damping_;
  std::optional<State<Vector>> start_;
};

}  // namespace springstab
