// What limits are asked of: the matrices of a structure at one state, and what its damping is.
//     M x'' = -K x - D v,   D = d0 M + alpha K where the damping is Rayleigh's (paper Eq. 28)
//
//     const Structure hanging = structure_of(scene, scene.rest_state());
//     const Structure from_files = structure_of(prepare(stiffness, mass, damping));
//     const Structure designed{prepare(stiffness), {.kind = DampingModel::Kind::designed, .d0 = 1}};
#pragma once

#include <functional>
#include <optional>

#include "solvers/linear/structural_matrices.h"
#include "solvers/state.h"
#include "solvers/system.h"

namespace springstab {

class Scene;
class SpringChain;

/// The damping of a structure, as far as limits depend on its form.
struct DampingModel {
  enum class Kind {
    none,
    rayleigh,  // d0 M + alpha K
    designed,  // d0 M + alpha K with alpha fitted to each method's step
    general    // anything else
  };
  Kind kind = Kind::none;
  double d0 = 0;             // [1/s]
  double alpha = 0;          // [s]
  bool semidefinite = true;  // D is positive semidefinite
};

/// Frobenius norms of M, K, D in units in which no unknown outweighs others, and products of two.
struct DampingProducts {
  double m, k, d, mk, dm, dk;
};

/// The least-squares fit of D by d0 M + alpha K; nothing where one of the two is negative beyond rounding.
/// Whether it fits is for others to see.
std::optional<DampingModel> rayleigh_fit(const DampingProducts& of);

/// Of entries of D beside √(size_i size_j), where Rayleigh's model is to hold.
inline constexpr double rayleigh_tolerance = 1e-12;

/// D of the matrices: none, Rayleigh if D = d0 M + alpha K fits to 1e-12 with d0, alpha >= 0, else general.
DampingModel classify_damping(const StructuralMatrices& s);

/// Rayleigh's, or where the scene has damping of its own, general: C is positive semidefinite.
DampingModel damping_of(const Scene& scene);
DampingModel damping_of(const SpringChain& chain);

/// Owns all that it says.
struct Structure {
  /// All of D where the damping is of kind `general`. Where two numbers say it, its matrix may be left out:
  /// then these are the matrices of the structure without its damping.
  StructuralMatrices matrices;
  DampingModel damping;
  /// Makes matrices that no pose exceeds (solvers/scene/every_pose.h), each time it is called; or nothing.
  std::function<StructuralMatrices()> every_pose{};
};

/// Of prepared matrices; what their damping is, is found out.
Structure structure_of(StructuralMatrices matrices);
/// Of a scene at a state, linearized as its hessian() says.
Structure structure_of(Scene& scene, const State<Vector>& state);
Structure structure_of(const SpringChain& chain);

}  // namespace springstab
