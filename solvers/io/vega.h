// Vega FEM's mesh files: vertices and tetrahedra, and nothing else of the format.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// Parses *VERTICES and *ELEMENTS of kind TET. *MATERIAL, *REGION and *SET are skipped, with what they
/// *INCLUDE: a scene has its own material. Throws InputError, with the line, for other elements, *INCLUDE of
/// vertices or elements (whose file is not opened), counts that differ from what is
/// there, and anything that is not exactly a number. `source` is the file's name, for messages.
TetMesh parse_vega(const std::string& source, std::string_view text);

}  // namespace springstab
