// Object file format (OFF) of Geomview in ASCII: vertices and faces, and nothing else of it.
#pragma once

#include <string>
#include <string_view>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Parses the vertices and the faces. What a prefix of the first word announces for each vertex (ST for
/// texture coordinates, C for a colour, N for a normal) and the colours behind a face are numbers and are
/// skipped. Throws InputError, with the line, for binary files, for other than three dimensions (4OFF, nOFF),
/// for counts that differ from what is there and for anything that is not exactly a number.
Mesh parse_off(const std::string& source, std::string_view text);

}  // namespace springstab
