// --area-density, --stretch, --bend and --mass-total: numbers of a material, or the weight of all, on the
// command line.
#pragma once

#include <optional>

#include "experiments/inputs/scene_description.h"

namespace springstab {

struct MaterialOptions {
  std::optional<double> area_density{};  // of a surface [kg/m²]
  std::optional<double> stretch{};       // of springs along edges, of triangles along u and v [N/m]
  std::optional<double> bend{};          // of springs across an edge [N/m], of hinges [N·m]
  std::optional<double> mass_total{};    // of all particles, pinned ones too [kg]

  bool any() const { return area_density || stretch || bend || mass_total; }
};

/// Throws InputError, which names the option, for a number that is not positive, for one of a surface where
/// the material is a solid's, and for two weights.
void apply(const MaterialOptions& options, SceneDescription& description);

}  // namespace springstab
