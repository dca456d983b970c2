// Contact of a scene's particles with obstacles, and of its surface with itself and with meshes, as the user
// describes it.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "solvers/contact/obstacle.h"

namespace springstab {

/// Impulses let a particle land on the obstacle and no more: 0 <= r ⟂ gap >= 0 at the position to come.
struct LandingImpulses {};
/// Impulses take all velocity into the obstacle as soon as the step to come would enter it.
struct InelasticImpulses {};
/// Springs and dampers (penalty.h, surface_penalty.h).
struct Penalty {
  double stiffness = 0;  // k_c [N/m]
  double damping = 0;    // d_c [N·s/m]
};
using ContactModel = std::variant<LandingImpulses, InelasticImpulses, Penalty>;

/// A surface, to be met from either side; it moves like an obstacle.
struct MeshObstacle {
  std::vector<Eigen::Vector3d> vertices;  // at t = 0 [m]
  std::vector<std::array<int, 3>> triangles;
  Eigen::Vector3d velocity{0, 0, 0};  // u [m/s]
};

struct Contact {
  std::vector<Obstacle> obstacles;
  double thickness = 0;  // of the cloth: the least distance [m]
  double friction = 0;   // Coulomb's μ
  ContactModel model;
  std::vector<MeshObstacle> meshes{};
  bool self = false;  // the cloth's surface meets itself

  /// Whether surfaces meet, which takes a positive thickness and the cloth's surface.
  bool has_surfaces() const { return self || !meshes.empty(); }
};

/// What of a cloth meets itself and meshes.
struct ClothSurface {
  std::vector<std::array<int, 3>> triangles;  // of particles: free ones as in the state, then pinned ones
  std::vector<Eigen::Vector3d> pinned;        // where they are [m]
};

}  // namespace springstab
