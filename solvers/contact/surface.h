// The surface of a cloth or an obstacle as what can touch: triangles, and of these every edge and vertex
// once.
#pragma once

#include <array>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Numbers are those of particles, in whatever list of places goes with it.
struct Surface {
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> edges;  // the smaller number first; sorted
  std::vector<int> vertices;              // sorted
};

/// Edges and vertices are those of the triangles. Throws std::invalid_argument where a triangle has a corner
/// twice, or a negative one.
Surface make_surface(std::vector<std::array<int, 3>> triangles);

/// The faces as fans of triangles; vertex i of the mesh is particle particle_of[i].
std::vector<std::array<int, 3>> triangles_of(const Mesh& mesh, const std::vector<int>& particle_of);

}  // namespace springstab
