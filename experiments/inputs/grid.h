// Grids as inputs: how their size is written, and their cells as faces of a picture.
#pragma once

#include <string>

#include "experiments/inputs/mesh_input.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab {

/// "NxM" as a grid. Throws InputError(source, ...).
Grid parse_grid(const std::string& text, const std::string& source);

/// "uniform" or "alternating". Throws InputError(source, line, ...).
Diagonals parse_diagonals(const std::string& word, const std::string& source, long line = 0);

/// Its cells.
Faces grid_faces(const Grid& grid);

}  // namespace springstab
