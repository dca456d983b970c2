// Gmsh's mesh files, in ASCII (formats 1, 2 and 4) or binary (2 and 4.1): nodes, triangles, quadrangles and
// tetrahedra, and nothing else of them (gmsh.info/doc/texinfo, "MSH file format" and its legacy versions).
#pragma once

#include <string>
#include <string_view>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Whether it begins as a binary file of this kind.
bool is_binary_gmsh(std::string_view beginning);

/// Parses the nodes and the elements of first order: a solid, where there are tetrahedra (element type 4),
/// else a surface of triangles and quadrangles (types 2 and 3). Elements of points and lines and sections
/// other than nodes and elements are skipped. Throws InputError, with the line or the byte, for other solid
/// elements, curved elements, counts that differ from what is there, and anything that is not exactly a
/// number. `source` is the file's name, for messages.
AnyMesh parse_gmsh(const std::string& source, std::string_view text);

}  // namespace springstab
