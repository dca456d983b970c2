// VTK's XML files of poly data (.vtp) and unstructured grids (.vtu): points and cells, and nothing else of
// them.
#pragma once

#include <string>
#include <string_view>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Whether it begins as XML does, behind which data may follow that are no text.
bool is_xml(std::string_view beginning);

/// Parses the points and cells of all pieces, one behind another: a solid, where there are tetrahedra, else a
/// surface, by the rules of parse_vtk. Data may be ascii, binary or appended, raw or in base64, compressed by
/// zlib or not. Throws InputError, with the line (of encoded numbers that of their array), for other cells,
/// for arrays that are missing or of other sizes than was announced, and for points that are not there.
AnyMesh parse_vtk_xml(const std::string& source, std::string_view text);

}  // namespace springstab
