// A mesh from whichever of the formats its name ends in.
#pragma once

#include <string>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Reads a surface or a solid: .obj, or no suffix as pipes have none (Wavefront), .msh (Gmsh), .veg (Vega
/// FEM) or .vtk (VTK legacy), in capitals or not. Throws InputError for other names and, with the line, for
/// whatever the format's reader refuses.
AnyMesh read_mesh(const std::string& path);

/// Whether such a file holds a solid: of .msh and .vtk what is in them tells, and they are read for it. True
/// where that fails: whoever then reads the mesh will say why.
bool holds_tetrahedra(const std::string& path);

}  // namespace springstab
