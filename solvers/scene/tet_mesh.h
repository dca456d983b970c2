// A mesh of tetrahedra as its file gave it: the geometry of a solid at rest, before any physics.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Tetrahedra over vertices, indices from 0. The source lines let an error that is found later still name its
/// line.
struct TetMesh {
  std::vector<Eigen::Vector3d> vertices;  // [m]
  std::vector<std::array<int, 4>> tets;
  std::string source;             // the file's name, for messages
  std::vector<long> vertex_line;  // one per vertex
  std::vector<long> tet_line;     // one per tetrahedron
  std::vector<FileNote> notes{};

  /// Six times the signed volume [m³]: positive where (x1 - x0, x2 - x0, x3 - x0) is right-handed.
  double six_volumes(int tet) const;
};

/// The corners of a tetrahedron's four faces, which turn counterclockwise as seen from outside where it is
/// right-handed.
inline constexpr int outward_faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// The triangles that belong to one tetrahedron only, facing outwards where that one is right-handed.
std::vector<std::vector<int>> boundary(const TetMesh& mesh);

/// Throw an InputError about a tetrahedron, with the mesh's file and, where it is known, the line.
[[noreturn]] void fail_at_tet(const TetMesh& mesh, int tet, const std::string& what);

}  // namespace springstab
