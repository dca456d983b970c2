// Wavefront OBJ: the polygons of a mesh, and nothing else of the format.
#pragma once

#include <string>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Reads the vertices (`v`) and the polygons (`f`) of an OBJ file. Texture and normal indices, groups,
/// materials, lines and free-form geometry are skipped; a statement that the format does not have is an
/// error. Throws InputError, with the line, for anything that is not exactly a number, an index in range, a
/// polygon of three or more corners; and where the file has no vertices or no faces.
Mesh read_obj(const std::string& path);

}  // namespace springstab
