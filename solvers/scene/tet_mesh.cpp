#include "solvers/scene/tet_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "solvers/io/input_error.h"

namespace springstab {

double TetMesh::six_volumes(int tet) const {
  const auto& c = tets[tet];
  const Eigen::Vector3d a = vertices[c[1]] - vertices[c[0]], b = vertices[c[2]] - vertices[c[0]];
  return a.cross(b).dot(vertices[c[3]] - vertices[c[0]]);
}

std::vector<std::vector<int>> boundary(const TetMesh& mesh) {
  struct Side {
    std::array<int, 3> sorted, outward;
    bool operator<(const Side& other) const { return sorted < other.sorted; }
  };
  std::vector<Side> sides;
  sides.reserve(4 * mesh.tets.size());
  for (const auto& tet : mesh.tets)
    for (const auto& face : outward_faces) {
      Side side{{}, {tet[face[0]], tet[face[1]], tet[face[2]]}};
      side.sorted = side.outward;
      std::ranges::sort(side.sorted);
      sides.push_back(side);
    }
  std::stable_sort(sides.begin(), sides.end());
  std::vector<std::vector<int>> outer;
  for (auto first = sides.begin(), last = first; first != sides.end(); first = last) {
    last = std::upper_bound(first, sides.end(), *first);
    if (last - first == 1) outer.emplace_back(first->outward.begin(), first->outward.end());
  }
  return outer;
}

void fail_at_tet(const TetMesh& mesh, int tet, const std::string& what) {
  const auto i = static_cast<std::size_t>(tet);
  throw InputError(mesh.source, i < mesh.tet_line.size() ? mesh.tet_line[i] : 0, what);
}

}  // namespace springstab
