#include "experiments/inputs/material_options.h"

#include <cmath>

#include "solvers/io/input_error.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

void check_option(const std::optional<double>& value, const char* option, const char* unit) {
  if (value && !positive(*value))
    throw InputError(option, 0,
                     "is " + springstab::shown(*value) + ", expected a positive number of " + unit);
}

}  // namespace

void apply(const MaterialOptions& options, SceneDescription& description) {
  check_option(options.area_density, "--area-density", "kg/m²");
  check_option(options.stretch, "--stretch", "N/m");
  check_option(options.bend, "--bend", "N/m for springs, N·m for triangles");
  check_option(options.mass_total, "--mass-total", "kg");
  if (options.area_density && options.mass_total)
    throw InputError("--area-density, --mass-total", 0, "are both given, expected one of them");
  description.total_mass = options.mass_total;
  if (std::holds_alternative<SolidMaterial>(description.material) &&
      (options.area_density || options.stretch || options.bend))
    throw InputError("--area-density, --stretch, --bend", 0,
                     "are for surfaces, expected --mass-total for a solid");
  const auto set = [](const std::optional<double>& value, double& of) { of = value.value_or(of); };
  if (auto* springs = std::get_if<SpringMaterial>(&description.material)) {
    set(options.area_density, springs->area_density);
    set(options.stretch, springs->stiffness.structural);
    set(options.bend, springs->stiffness.bending);
  } else if (auto* cloth = std::get_if<ClothMaterial>(&description.material)) {
    set(options.area_density, cloth->area_density);
    set(options.stretch, cloth->stiffness.stretch_u);
    set(options.stretch, cloth->stiffness.stretch_v);
    set(options.bend, cloth->stiffness.bending);
  }
}

}  // namespace springstab
