// The nodes and elements of Gmsh's binary formats 2 and 4.1 (gmsh.info/doc/texinfo, "MSH file format").
#pragma once

#include "solvers/io/binary_reader.h"
#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Read to the end of a section of version 4.1 from its beginning.
void read_gmsh_nodes(BinaryReader& bytes, MeshBuilder& builder);
void read_gmsh_elements(BinaryReader& bytes, MeshBuilder& builder);

/// The same of version 2 from behind the line that says how many there are.
void read_gmsh_2_nodes(BinaryReader& bytes, long long count, MeshBuilder& builder);
void read_gmsh_2_elements(BinaryReader& bytes, long long count, MeshBuilder& builder);

}  // namespace springstab
