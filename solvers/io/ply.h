// Polygon files (PLY), in ASCII or binary of either byte order: vertices, faces and texture coordinates, and
// nothing else of them (G. Turk, "The PLY Polygon File Format", 1994).
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Whether it begins as a binary PLY file.
bool is_binary_ply(std::string_view beginning);

/// Parses x, y, z of the vertices in the precision that they have, the corners of the faces (vertex_indices
/// or vertex_index) and, where each vertex has a pair of them (s t, u v, texture_u texture_v), texture
/// coordinates. Other properties are skipped; elements other than vertices and faces are left out, which the
/// notes tell, as they do of faces with one or two corners. Throws InputError, with the line or the byte, for
/// whatever is not as the header says, and for counts that the file cannot back, before anything is allocated
/// for them.
Mesh parse_ply(const std::string& source, std::string_view text);

}  // namespace springstab
