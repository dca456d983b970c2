// The elements of Gmsh's mesh files, as parts of a mesh.
#pragma once

#include <span>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// What a mesh makes of a type of element.
enum class GmshShape { skipped, curved_surface, triangle, quadrangle, tetrahedron };

/// Points and lines are skipped. Fails for solid elements other than tetrahedra of first order.
GmshShape gmsh_shape(long long type, const Location& at);

/// How many nodes an element has whose shape was found, as binary files need to know.
int gmsh_nodes(long long type);

/// Adds an element of a type that was checked, with these numbers of nodes.
void add_gmsh_element(MeshBuilder& builder, long long type, std::span<const long long> nodes,
                      const Location& at);

}  // namespace springstab
