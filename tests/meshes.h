// Meshes from lists, as a reader would have made them: vertices and faces on consecutive lines of cloth.obj.
#pragma once

#include <utility>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab::test {

using Faces = std::vector<std::vector<int>>;

inline Mesh make_mesh(std::vector<Eigen::Vector3d> vertices, const Faces& faces) {
  Mesh mesh;
  mesh.source = "cloth.obj";
  mesh.vertices = std::move(vertices);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertex_line.push_back(static_cast<long>(v) + 1);
  for (const auto& face : faces) {
    mesh.face_vertices.insert(mesh.face_vertices.end(), face.begin(), face.end());
    mesh.face_offsets.push_back(static_cast<int>(mesh.face_vertices.size()));
    mesh.face_line.push_back(static_cast<long>(mesh.vertices.size() + mesh.face_line.size() + 1));
  }
  return mesh;
}

inline Faces faces_of(const Mesh& mesh) {
  Faces faces;
  for (int f = 0; f < mesh.faces(); ++f) faces.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
  return faces;
}

}  // namespace springstab::test
