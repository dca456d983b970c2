// What every cloth asks of a mesh, whatever is made of it.
#include "solvers/scene/mesh.h"

#include <algorithm>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

[[noreturn]] void fail_at(const Mesh& mesh, const std::vector<long>& lines, int index,
                          const std::string& what) {
  // A mesh that was not read from a file may have no lines.
  const auto i = static_cast<std::size_t>(index);
  throw InputError(mesh.source, i < lines.size() ? lines[i] : 0, what);
}

void check_face(const Mesh& mesh, int f) {
  std::vector<int> corners(mesh.face(f).begin(), mesh.face(f).end());
  std::sort(corners.begin(), corners.end());
  const int vertices = static_cast<int>(mesh.vertices.size());
  if (corners.size() < 3)
    fail_at_face(mesh, f, "face has " + std::to_string(corners.size()) + " corners, expected at least 3");
  for (const int v : {corners.front(), corners.back()})
    if (v < 0 || v >= vertices)
      fail_at_face(
          mesh, f,
          "face names vertex " + std::to_string(v + 1) + ", expected 1 to " + std::to_string(vertices));
  const auto twice = std::adjacent_find(corners.begin(), corners.end());
  if (twice != corners.end())
    fail_at_face(
        mesh, f,
        "face has the same vertex " + std::to_string(*twice + 1) + " twice, expected distinct corners");
}

}  // namespace

void check(const Mesh& mesh) {
  if (mesh.faces() < 1) throw InputError(mesh.source, 0, "the mesh has no faces, expected at least one");
  const int vertices = static_cast<int>(mesh.vertices.size());
  for (int v = 0; v < vertices; ++v)
    if (!mesh.vertices[v].allFinite())
      fail_at_vertex(mesh, v, "has a coordinate that is not finite, expected three finite numbers");
  std::vector<bool> used(mesh.vertices.size(), false);
  for (int f = 0; f < mesh.faces(); ++f) {
    check_face(mesh, f);
    for (const int v : mesh.face(f)) used[v] = true;
  }
  const auto loose = std::find(used.begin(), used.end(), false);
  if (loose != used.end())
    fail_at_vertex(
        mesh, static_cast<int>(loose - used.begin()),
        "belongs to no face and would have no mass and no forces, expected a face at every vertex");
}

void fail_at_face(const Mesh& mesh, int face, const std::string& what) {
  fail_at(mesh, mesh.face_line, face, what);
}

void fail_at_vertex(const Mesh& mesh, int vertex, const std::string& what) {
  fail_at(mesh, mesh.vertex_line, vertex, "vertex " + std::to_string(vertex + 1) + " " + what);
}

}  // namespace springstab
