#include "solvers/contact/surface.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace springstab {
namespace {

template <class T>
void sort_and_make_unique(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

Surface make_surface(std::vector<std::array<int, 3>> triangles) {
  Surface surface{std::move(triangles), {}, {}};
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const std::array<int, 3>& t = surface.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || std::min({t[0], t[1], t[2]}) < 0)
      throw std::invalid_argument("triangle " + std::to_string(i) + " has the corners " +
                                  std::to_string(t[0]) + ", " + std::to_string(t[1]) + " and " +
                                  std::to_string(t[2]) + ", expected three different particles");
    for (int k = 0; k < 3; ++k) {
      surface.vertices.push_back(t[k]);
      surface.edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
  }
  sort_and_make_unique(surface.vertices);
  sort_and_make_unique(surface.edges);
  return surface;
}

std::vector<std::array<int, 3>> triangles_of(const Mesh& mesh, const std::vector<int>& particle_of) {
  std::vector<std::array<int, 3>> triangles;
  for (int f = 0; f < mesh.faces(); ++f) {
    const std::span<const int> face = mesh.face(f);
    for (std::size_t c = 2; c < face.size(); ++c)
      triangles.push_back({particle_of[face[0]], particle_of[face[c - 1]], particle_of[face[c]]});
  }
  return triangles;
}

}  // namespace springstab
