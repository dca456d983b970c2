// Wavefront OBJ: the polygons of a mesh, their texture coordinates, groups and materials, and nothing else of
// the format.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Parses the vertices (`v`), the polygons (`f`) and, where every corner of every polygon names one, the
/// texture coordinates (`vt`) of an OBJ file. The mesh's notes tell what else there is that has a place in
/// space or belongs to a vertex and is not read (lines, points, free-form geometry, weights, creases), faces
/// of one or two corners, which are dropped, and why texture coordinates are not used where something is
/// wrong with them. Groups and materials are kept as attributes of the faces, normals are skipped without a
/// word; a statement that the format
/// does not have is an error. Throws InputError, with the line, for anything that is not exactly a number or
/// an index in range (of a normal: an index), and where the file has no vertices or no faces.
Mesh parse_obj(const std::string& source, std::string_view text);

/// The same of a file.
Mesh read_obj(const std::string& path);

}  // namespace springstab
