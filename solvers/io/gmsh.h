// The ASCII formats 1 and 2 of Gmsh's mesh files: nodes and tetrahedra, and nothing else of them.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// Parses the nodes and the tetrahedra of first order (element type 4). Elements of points, lines and
/// surfaces and sections other than nodes and elements are skipped. Throws InputError, with the line, for
/// other solid elements, binary files, format 4, counts that differ from what is there, and anything that is
/// not exactly a number. `source` is the file's name, for messages.
TetMesh parse_gmsh(const std::string& source, std::string_view text);

}  // namespace springstab
