// Wavefront OBJ: the polygons of a mesh and their texture coordinates, and nothing else of the format.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Parses the vertices (`v`), the polygons (`f`) and, where every corner of every polygon names one, the
/// texture coordinates (`vt`) of an OBJ file. Normal indices, groups, materials, lines and free-form geometry
/// are skipped; a statement that the format does not have is an error. Throws InputError, with the line, for
/// anything that is not exactly a number, an index in range (of a normal: an index), a polygon of three or
/// more corners; and where the file has no vertices or no faces.
Mesh parse_obj(const std::string& source, std::string_view text);

/// The same of a file.
Mesh read_obj(const std::string& path);

}  // namespace springstab
