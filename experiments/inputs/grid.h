// Grids as inputs: how their size is written, and their cells as faces of a picture.
#pragma once

#include <string>

#include "experiments/inputs/mesh_input.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab {

/// "NxM" as a grid. Throws InputError(source, ...).
Grid parse_grid(const std::string& text, const std::string& source);

/// Its cells.
Faces grid_faces(const Grid& grid);

}  // namespace springstab
