// A mesh of tetrahedra from whichever of the formats its name ends in.
#pragma once

#include <string>

#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// Whether the name ends in .msh (Gmsh), .veg (Vega FEM) or .vtk (VTK legacy), in capitals or not.
bool is_tet_file(const std::string& path);

/// Reads such a file. Throws InputError, with the line, for whatever its reader refuses.
TetMesh read_tets(const std::string& path);

}  // namespace springstab
