// The paper's draping cloth (Fig. 4): a square sheet let go flat, held along its first row or otherwise.
#pragma once

#include "experiments/inputs/scene_description.h"

namespace springstab {

/// side × side particles, always 0.025 m apart and of 1.25e-4 kg: a larger sheet has more particles, not
/// other ones, and so nearly the same k0.
struct Drape {
  int side = 16;
  double stiffness_factor = 1;  // on every elastic coefficient: K and k0 are proportional to it
  Material material = ClothMaterial{.particle_mass = 1.25e-4};
  Pins pins{.kind = Pins::Kind::first_row, .ranges = {}, .source = "drape"};
  RayleighDescription damping{.d0 = 10, .alpha = std::nullopt};  // alpha fitted to the step
};

/// No collisions, gravity (0, -9.81, 0), the sheet in the xz-plane.
SceneDescription describe(const Drape& drape);

}  // namespace springstab
