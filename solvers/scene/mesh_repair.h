// Mends what files of meshes have and no cloth can be made of. Only what has one right answer is mended:
// vertices in exactly one place are one vertex, and what then has too few corners, stands there twice or is
// used by nothing, goes. All else (a triangle without area, say) is left to whoever builds on the mesh, to
// refuse with its line.
#pragma once

#include <vector>

#include "solvers/scene/mesh.h"
#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// What was mended, in numbers, and what is unusual but stays. Elements are the faces of a surface or the
/// tetrahedra of a solid.
struct MeshRepair {
  int merged_vertices = 0;        // into the first one in exactly their place (0 and -0 are one coordinate)
  int shortened_elements = 0;     // faces that lost a corner that was there twice in a row
  int degenerate_elements = 0;    // dropped: fewer than three (four) corners were left
  int duplicate_elements = 0;     // dropped: the same corners, of a face also their order or its reverse
  int unreferenced_vertices = 0;  // dropped: no element has them
  int turned_elements = 0;        // left-handed tetrahedra, made right-handed
  int crowded = 0;                // these stay: edges of more than two faces; faces of more than two
                                  // tetrahedra or of two on one side, which overlap

  /// Of each vertex of the file its number in the mended mesh; -1 for an unreferenced one.
  std::vector<int> vertex;

  bool changed() const {
    return merged_vertices > 0 || shortened_elements > 0 || degenerate_elements > 0 ||
           duplicate_elements > 0 || unreferenced_vertices > 0 || turned_elements > 0;
  }
};

/// The mesh that is left of `mesh`, whose faces name vertices that exist. It passes `check(mesh)` unless a
/// coordinate is not finite or a face meets itself. Throws InputError at the first face that was dropped if
/// no face is left.
struct RepairedMesh {
  Mesh mesh;
  MeshRepair repair;
};
RepairedMesh repaired(const Mesh& mesh);

/// The same of tetrahedra. All that are left have four corners in different places and are right-handed,
/// unless they have no volume at all.
struct RepairedTets {
  TetMesh mesh;
  MeshRepair repair;
};
RepairedTets repaired(const TetMesh& mesh);

}  // namespace springstab
