// Contact of a scene's particles with obstacles, as the user describes it.
#pragma once

#include <variant>
#include <vector>

#include "solvers/contact/obstacle.h"

namespace springstab {

/// Impulses let a particle land on the obstacle and no more: 0 <= r ⟂ gap >= 0 at the position to come.
struct LandingImpulses {};
/// Impulses take all velocity into the obstacle as soon as the step to come would enter it.
struct InelasticImpulses {};
/// Springs and dampers (penalty.h).
struct Penalty {
  double stiffness = 0;  // k_c [N/m]
  double damping = 0;    // d_c [N·s/m]
};
using ContactModel = std::variant<LandingImpulses, InelasticImpulses, Penalty>;

struct Contact {
  std::vector<Obstacle> obstacles;
  double thickness = 0;  // of the cloth: the least distance [m]
  double friction = 0;   // Coulomb's μ
  ContactModel model;
};

}  // namespace springstab
