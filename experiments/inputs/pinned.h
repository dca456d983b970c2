// Which particles the notation for pins (scene_description.h) means in a grid or a mesh.
#pragma once

#include <vector>

#include "experiments/inputs/mesh_input.h"
#include "experiments/inputs/scene_description.h"

namespace springstab {

/// Ascending numbers of the pinned particles. Throws InputError for one that is not there, and for a group,
/// an object or a box that has none.
std::vector<int> pinned_particles(const Pins& pins, const Grid& grid);
/// Of a mesh, whose pins name the file's vertices; `faces` are the file's.
std::vector<int> pinned_particles(const Pins& pins, const MeshFile& file, const Faces& faces);

}  // namespace springstab
