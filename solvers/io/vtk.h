// VTK's legacy files, in ASCII or binary: the points, tetrahedra and polygons of an unstructured grid or of
// poly data, and nothing else of them (VTK File Formats, "Simple Legacy Formats").
#pragma once

#include <string>
#include <string_view>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Whether it begins as a binary file of this kind.
bool is_binary_vtk(std::string_view beginning);

/// Parses the points and the cells of an unstructured grid or of poly data, with cells as versions up to 4
/// write them (count and corners) or as version 5 does (offsets and connectivity): a solid, where there are
/// tetrahedra (type 10), else a surface of triangles, strips of them, quadrangles and polygons (types 5 to
/// 9). Points and lines are skipped, as are fields, metadata and what belongs to points and cells. Throws
/// InputError, with the line or the byte, for other solid cells, curved cells, other kinds of data, counts
/// that differ from what is there, and anything that is not exactly a number. `source` is the file's name,
/// for messages.
AnyMesh parse_vtk(const std::string& source, std::string_view text);

}  // namespace springstab
