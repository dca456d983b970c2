// INPUT of the command line: which options say it, what goes with what, and the scene that they describe.
#pragma once

#include <optional>
#include <string>

#include "experiments/inputs/material_options.h"
#include "experiments/inputs/scene_description.h"
#include "solvers/linear/rayleigh_damping.h"

namespace springstab {

/// INPUT as typed; empty strings were not given. Exactly one of file, grid and stiffness must be.
struct InputOptions {
  std::string file;               // SCENE.json or a mesh
  std::string grid;               // "NxM"
  std::optional<double> spacing;  // [m], with grid
  std::string material, pin;      // with grid or a mesh
  std::optional<double> scale;    // of a scene's geometry
  std::string diagonals;          // with grid
  MaterialOptions numbers{};      // with grid or a mesh
  std::string stiffness, mass, damping_matrix, implicit_damping_matrix;
  bool sum_duplicates = false;  // of these matrices' entries
  std::string rayleigh;         // "d0,alpha": damping of matrices beside D
};

/// Throws InputError unless exactly one of file, grid and stiffness is given, with what goes with it.
void check(const InputOptions& options);
/// The scene they say. Throws InputError likewise.
SceneDescription describe(const InputOptions& options);
/// --rayleigh "d0,alpha"; none where that is empty. Throws InputError.
RayleighDamping rayleigh_of(const InputOptions& options);

/// Whether a file is a scene, by its suffix.
bool is_scene_file(const std::string& path);

}  // namespace springstab
