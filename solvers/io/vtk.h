// VTK's legacy files in ASCII: the points and tetrahedra of an unstructured grid, and nothing else of them.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// Parses the points and the cells of type 10 of an unstructured grid, with cells as versions up to 4 write
/// them (count and corners) or as version 5 does (offsets and connectivity). Cells of points, lines and
/// surfaces are skipped, as are fields, metadata and what belongs to points and cells. Throws InputError,
/// with the line, for other solid cells, binary files, other kinds of data, counts that differ from what is
/// there, and anything that is not exactly a number. `source` is the file's name, for messages.
TetMesh parse_vtk(const std::string& source, std::string_view text);

}  // namespace springstab
