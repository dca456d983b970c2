// Stereolithography files (STL), in ASCII or binary: triangles without vertices of their own.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Whether what begins so is a binary STL file: nothing marks one, but it counts its triangles and is not
/// text.
bool is_binary_stl(std::string_view beginning);

/// Parses the triangles. Corners at exactly the same place become one vertex, in the order in which the file
/// first has them, which a note tells; normals and attributes are skipped. A file is binary where its size is
/// what the count at byte 80 asks for, whatever it begins with. Throws InputError, with the line or the byte,
/// for anything else.
Mesh parse_stl(const std::string& source, std::string_view text);

}  // namespace springstab
