#include "experiments/inputs/input_options.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "experiments/inputs/grid.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         std::equal(ending.rbegin(), ending.rend(), text.rbegin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

}  // namespace

bool is_scene_file(const std::string& path) { return ends_with(path, ".json"); }

SceneDescription describe(const InputOptions& options) {
  if (options.scale && !(*options.scale > 0 && std::isfinite(*options.scale)))
    throw InputError("--scale", 0,
                     "is " + springstab::shown(*options.scale) + ", expected a positive number");
  if (is_scene_file(options.file)) {
    if (options.spacing || !options.material.empty() || !options.pin.empty() || !options.diagonals.empty())
      throw InputError(options.file, 0,
                       "--spacing, --diagonals, --material and --pin stand in the scene file itself");
    if (options.numbers.any())
      throw InputError(
          options.file, 0,
          "--area-density, --stretch, --bend and --mass-total are for grids and meshes, the scene "
          "file has its material itself");
    SceneDescription description = read_scene_file(options.file);
    if (options.scale && description.scale != 1)
      throw InputError(options.file, 0,
                       "--scale stands beside the scene's own 'scale', expected one of them");
    description.scale *= options.scale.value_or(1);
    return description;
  }
  SceneDescription description;
  description.scale = options.scale.value_or(1);
  if (options.grid.empty()) {
    if (options.spacing) throw InputError("--spacing", 0, "is for --grid only");
    if (!options.diagonals.empty()) throw InputError("--diagonals", 0, "is for --grid only");
    description.geometry = options.file;
  } else {
    Grid grid = parse_grid(options.grid, "--grid");
    if (options.spacing) grid.spacing = *options.spacing;
    if (!options.diagonals.empty()) grid.diagonals = parse_diagonals(options.diagonals, "--diagonals");
    check(grid, "--grid");
    description.geometry = grid;
  }
  description.material = named_material(options.material.empty() ? "default" : options.material,
                                        is_solid(description.geometry), "--material", 0);
  apply(options.numbers, description);
  if (!options.pin.empty()) description.pins = parse_pins(options.pin, "--pin", 0);
  return description;
}

// Rates of damping [1/s] and times [s], not negative.
RayleighDamping rayleigh_of(const InputOptions& options) {
  const std::string& words = options.rayleigh;
  if (words.empty()) return {};
  const Location at{"--rayleigh", 0};
  const std::size_t comma = words.find(',');
  if (comma == std::string::npos)
    at.fail(springstab::quoted(words) + " has no comma, expected d0,alpha like 0.5,1e-4");
  const RayleighDamping damping{at.real(words.substr(0, comma)), at.real(words.substr(comma + 1))};
  if (damping.d0 < 0 || damping.alpha < 0)
    at.fail(springstab::quoted(words) + " is negative, expected d0 and alpha from 0");
  return damping;
}

void check(const InputOptions& options) {
  const int given = !options.file.empty() + !options.grid.empty() + !options.stiffness.empty();
  if (given != 1)
    throw InputError("input", 0,
                     std::string(given == 0 ? "nothing was given" : "more than one was given") +
                         ", expected one of SCENE.json, a mesh, --grid NxM or --stiffness K.mtx");
  if (options.stiffness.empty()) {
    if (!options.mass.empty() || !options.damping_matrix.empty() || !options.rayleigh.empty() ||
        !options.implicit_damping_matrix.empty() || options.sum_duplicates)
      throw InputError("input", 0,
                       "--mass, --damping-matrix, --implicit-damping-matrix, --rayleigh and "
                       "--sum-duplicates go with --stiffness");
    return;
  }
  if (options.spacing || !options.material.empty() || !options.pin.empty() || options.scale ||
      !options.diagonals.empty())
    throw InputError(options.stiffness, 0,
                     "--spacing, --diagonals, --scale, --material and --pin are for grids and meshes");
  if (options.numbers.any())
    throw InputError(options.stiffness, 0,
                     "--area-density, --stretch, --bend and --mass-total are for grids and meshes");
}

}  // namespace springstab
