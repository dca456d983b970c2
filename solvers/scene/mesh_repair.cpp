#include "solvers/scene/mesh_repair.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <set>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

/// Of each vertex the first one in its place. By the bits of the coordinates, which order all numbers.
std::vector<int> first_in_place(const std::vector<Eigen::Vector3d>& vertices) {
  const auto place = [&](int v) {
    std::array<std::uint64_t, 3> bits{};
    for (int r = 0; r < 3; ++r) bits[r] = std::bit_cast<std::uint64_t>(vertices[v][r] + 0.0);  // -0 + 0 = 0
    return bits;
  };
  std::vector<int> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(place(a), a) < std::pair(place(b), b); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool again = k > 0 && place(order[k - 1]) == place(order[k]);
    first[order[k]] = again ? first[order[k - 1]] : order[k];
  }
  return first;
}

/// Numbers the vertices that are used, in their order; each other one has the number of the first one in its
/// place, if that has one.
void number_vertices(const std::vector<int>& first, const std::vector<bool>& used, MeshRepair& repair) {
  int next = 0;
  repair.vertex.assign(first.size(), -1);
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (used[v]) repair.vertex[v] = next++;
    if (first[v] != static_cast<int>(v)) repair.vertex[v] = repair.vertex[first[v]];
    if (repair.vertex[v] < 0) {
      ++repair.unreferenced_vertices;
    } else if (first[v] != static_cast<int>(v)) {
      ++repair.merged_vertices;
    }
  }
}

template <class T>
std::vector<T> kept(const std::vector<T>& all, const std::vector<bool>& used) {
  std::vector<T> some;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used[i]) some.push_back(all[i]);
  return some;
}

/// The polygon from its smallest corner on, towards the smaller of that one's neighbours.
std::vector<int> canonical(std::vector<int> corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  if (corners[1] > corners.back()) std::reverse(corners.begin() + 1, corners.end());
  return corners;
}

int crowded_edges(const Mesh& mesh) {
  std::vector<std::pair<int, int>> edges;
  for (int f = 0; f < mesh.faces(); ++f) {
    const auto corners = mesh.face(f);
    for (std::size_t k = 0; k < corners.size(); ++k)
      edges.push_back(std::minmax({corners[k], corners[(k + 1) % corners.size()]}));
  }
  std::sort(edges.begin(), edges.end());
  int crowded = 0;
  for (auto first = edges.begin(), last = first; first != edges.end(); first = last) {
    last = std::find_if(first, edges.end(), [&](const auto& edge) { return edge != *first; });
    crowded += last - first > 2;
  }
  return crowded;
}

int crowded_faces(const TetMesh& mesh) {
  // each face as its tetrahedron sees it from outside: an even turn of the sorted corners, or an odd one
  std::vector<std::pair<std::array<int, 3>, bool>> sides;
  for (const auto& tet : mesh.tets)
    for (const auto& face : outward_faces) {
      std::array<int, 3> c{tet[face[0]], tet[face[1]], tet[face[2]]};
      const bool odd = (c[0] > c[1]) != ((c[0] > c[2]) != (c[1] > c[2]));
      std::ranges::sort(c);
      sides.emplace_back(c, odd);
    }
  std::sort(sides.begin(), sides.end());
  int crowded = 0;
  for (auto first = sides.begin(), last = first; first != sides.end(); first = last) {
    last = std::find_if(first, sides.end(), [&](const auto& side) { return side.first != first->first; });
    crowded += last - first > 2 || (last - first == 2 && first->second == (first + 1)->second);
  }
  return crowded;
}

}  // namespace

RepairedMesh repaired(const Mesh& mesh) {
  const std::vector<int> first = first_in_place(mesh.vertices);
  RepairedMesh result;
  auto& [out, repair] = result;
  out.source = mesh.source;
  std::vector<bool> used(mesh.vertices.size(), false);
  std::set<std::vector<int>> seen;
  int first_dropped = -1;
  for (int f = 0; f < mesh.faces(); ++f) {
    const int begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
    std::vector<int> corners, places;  // places: in mesh.face_vertices
    for (int place = begin; place < end; ++place) {
      const int v = first[mesh.face_vertices[place]];
      if (!corners.empty() && corners.back() == v) continue;
      corners.push_back(v);
      places.push_back(place);
    }
    while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
    places.resize(corners.size());
    const bool degenerate = corners.size() < 3;
    if (degenerate || !seen.insert(canonical(corners)).second) {
      ++(degenerate ? repair.degenerate_elements : repair.duplicate_elements);
      if (first_dropped < 0) first_dropped = f;
      continue;
    }
    repair.shortened_elements += static_cast<int>(corners.size()) < end - begin;
    for (const int v : corners) used[v] = true;
    out.face_vertices.insert(out.face_vertices.end(), corners.begin(), corners.end());
    out.face_offsets.push_back(static_cast<int>(out.face_vertices.size()));
    if (!mesh.face_line.empty()) out.face_line.push_back(mesh.face_line[f]);
    if (!mesh.corner_uv.empty())
      for (const int place : places) out.corner_uv.push_back(mesh.corner_uv[place]);
  }
  if (first_dropped >= 0 && out.faces() == 0)
    fail_at_face(mesh, first_dropped,
                 "the face has fewer than three corners in different places, as all others have, expected a "
                 "face with an area");
  number_vertices(first, used, repair);
  for (int& v : out.face_vertices) v = repair.vertex[v];
  out.vertices = kept(mesh.vertices, used);
  if (!mesh.vertex_line.empty()) out.vertex_line = kept(mesh.vertex_line, used);
  repair.crowded = crowded_edges(out);
  return result;
}

RepairedTets repaired(const TetMesh& mesh) {
  const std::vector<int> first = first_in_place(mesh.vertices);
  RepairedTets result;
  auto& [out, repair] = result;
  out.source = mesh.source;
  std::vector<bool> used(mesh.vertices.size(), false);
  std::set<std::array<int, 4>> seen;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    std::array<int, 4> tet = mesh.tets[t];
    for (int& v : tet) v = first[v];
    std::array<int, 4> sorted = tet;
    std::ranges::sort(sorted);
    const bool degenerate = std::ranges::adjacent_find(sorted) != sorted.end();
    if (degenerate || !seen.insert(sorted).second) {
      ++(degenerate ? repair.degenerate_elements : repair.duplicate_elements);
      continue;
    }
    for (const int v : tet) used[v] = true;
    out.tets.push_back(tet);
    if (!mesh.tet_line.empty()) out.tet_line.push_back(mesh.tet_line[t]);
  }
  if (!mesh.tets.empty() && out.tets.empty())
    fail_at_tet(
        mesh, 0,
        "the tetrahedron has fewer than four corners in different places, as all others have, expected "
        "one with a volume");
  number_vertices(first, used, repair);
  for (auto& tet : out.tets)
    for (int& v : tet) v = repair.vertex[v];
  out.vertices = kept(mesh.vertices, used);
  if (!mesh.vertex_line.empty()) out.vertex_line = kept(mesh.vertex_line, used);
  for (int t = 0; t < static_cast<int>(out.tets.size()); ++t)
    if (out.six_volumes(t) < 0) {
      std::swap(out.tets[t][2], out.tets[t][3]);
      ++repair.turned_elements;
    }
  repair.crowded = crowded_faces(out);
  return result;
}

}  // namespace springstab
