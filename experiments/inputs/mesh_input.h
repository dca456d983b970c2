// Mesh files as inputs: read, mended, and what pictures and reports need to know of how they were.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "solvers/scene/mesh.h"
#include "solvers/scene/mesh_repair.h"
#include "solvers/scene/tet_mesh.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab {

/// Of pictures: numbers of vertices.
using Faces = std::vector<std::vector<int>>;

/// A mesh file as it was, and what was mended to make a scene of it.
struct MeshFile {
  std::string path;
  bool solid;                             // of tetrahedra
  std::vector<Eigen::Vector3d> vertices;  // [m]
  MeshRepair repair;
  std::vector<FileNote> notes;  // on what its reader left out
  FaceAttributes attributes{};  // of the faces of an OBJ file

  // of a cloth of triangles:
  std::optional<RestShape> rest_shape{};
  std::optional<TextureMap> texture_map{};
};

/// Where the file's vertices are when the particles are at these places: one that was merged is where its
/// particle is, an unreferenced one at its own place times `stretch`.
std::vector<Eigen::Vector3d> file_vertices(const MeshFile& file,
                                           const std::vector<Eigen::Vector3d>& particles,
                                           const Eigen::Vector3d& stretch);

struct SurfaceInput {
  Mesh mesh;  // mended
  MeshFile file;
  Faces faces;  // of the file
};
SurfaceInput surface_input(Mesh original);

struct SolidInput {
  TetMesh mesh;  // mended
  MeshFile file;
  Faces faces;  // of its surface
};
SolidInput solid_input(TetMesh original);

}  // namespace springstab
