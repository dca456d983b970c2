// From a grid or a mesh to masses and springs. Both ways emit the springs sorted by their particles, so a
// grid and its quad mesh give the same list.
#include "solvers/scene/spring_cloth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "solvers/io/input_error.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

enum class SpringKind { structural, shear, bending };  // in order of precedence

double of(const PerKind& values, SpringKind kind) {
  switch (kind) {
    case SpringKind::structural:
      return values.structural;
    case SpringKind::shear:
      return values.shear;
    default:
      return values.bending;
  }
}

void add_spring(SpringNet& net, int i, int j, SpringKind kind, const SpringMaterial& material) {
  const double length = (net.rest[j] - net.rest[i]).norm();
  net.springs.push_back({i, j, of(material.stiffness, kind), of(material.damping, kind), length});
}

// --- meshes ---

/// Half the length of the sum of the fan's cross products [m²]; a face as thin as rounding is given none.
double face_area(const Mesh& mesh, int f) {
  const auto corners = mesh.face(f);
  const Eigen::Vector3d& apex = mesh.vertices[corners[0]];
  Eigen::Vector3d doubled{0, 0, 0};
  double longest_squared = 0;
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const Eigen::Vector3d side = mesh.vertices[corners[k]] - apex;
    longest_squared = std::max(longest_squared, side.squaredNorm());
    if (k + 1 < corners.size()) doubled += side.cross(mesh.vertices[corners[k + 1]] - apex);
  }
  const double area = doubled.norm() / 2;
  return area > 1e-12 * longest_squared ? area : 0;
}

std::vector<double> particle_masses(const Mesh& mesh, const SpringMaterial& material) {
  if (material.particle_mass) return std::vector<double>(mesh.vertices.size(), *material.particle_mass);
  std::vector<double> mass(mesh.vertices.size(), 0);
  for (int f = 0; f < mesh.faces(); ++f) {
    const auto corners = mesh.face(f);
    const double share = material.area_density * face_area(mesh, f) / static_cast<double>(corners.size());
    for (const int v : corners) mass[v] += share;
  }
  for (int v = 0; v < static_cast<int>(mass.size()); ++v)
    if (!positive(mass[v]))
      fail_at_vertex(mesh, v,
                     "has a mass of " + shown(mass[v]) +
                         " kg from the area of its faces, expected a positive finite one");
  return mass;
}

/// An edge as one of its faces sees it: low < high, and the neighbours of both ends farther along that face.
struct Side {
  int low, high;
  int beyond_low, beyond_high;
  int face;
};

struct Pair {
  int i, j;
  SpringKind kind;
  int face;  // for messages
};

/// The sides of all faces, those of one edge next to each other.
std::vector<Side> sides_by_edge(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(mesh.face_vertices.size());
  for (int f = 0; f < mesh.faces(); ++f) {
    const auto corners = mesh.face(f);
    const std::size_t n = corners.size();
    for (std::size_t k = 0; k < n; ++k) {
      const int before = corners[(k + n - 1) % n], a = corners[k];
      const int b = corners[(k + 1) % n], after = corners[(k + 2) % n];
      sides.push_back(a < b ? Side{a, b, before, after, f} : Side{b, a, after, before, f});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return std::tie(s.low, s.high, s.face) < std::tie(t.low, t.high, t.face);
  });
  return sides;
}

/// Which particles of the mesh are joined, once each, by the first kind that joins them.
std::vector<Pair> joined_pairs(const Mesh& mesh, const PerKind& stiffness) {
  std::vector<Pair> pairs;
  const auto join = [&](int a, int b, SpringKind kind, int face) {
    if (a != b && of(stiffness, kind) > 0) pairs.push_back({std::min(a, b), std::max(a, b), kind, face});
  };
  for (int f = 0; f < mesh.faces(); ++f) {
    const auto corners = mesh.face(f);
    const std::size_t n = corners.size();
    for (std::size_t k = 0; n > 3 && k < n; ++k) join(corners[k], corners[(k + 2) % n], SpringKind::shear, f);
  }
  const std::vector<Side> sides = sides_by_edge(mesh);
  for (auto first = sides.begin(), last = first; first != sides.end(); first = last) {
    join(first->low, first->high, SpringKind::structural, first->face);
    for (; last != sides.end() && last->low == first->low && last->high == first->high; ++last) {
      if (last - first == most_faces_at_edge)
        fail_at_face(mesh, last->face,
                     "face is one of more than " + std::to_string(most_faces_at_edge) + " at the edge " +
                         std::to_string(first->low + 1) + "-" + std::to_string(first->high + 1) +
                         ", expected at most that many");
      for (auto other = first; other != last; ++other) {
        join(other->beyond_low, last->beyond_low, SpringKind::bending, last->face);
        join(other->beyond_high, last->beyond_high, SpringKind::bending, last->face);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tie(p.i, p.j, p.kind, p.face) < std::tie(q.i, q.j, q.kind, q.face);
  });
  const auto same = [](const Pair& p, const Pair& q) { return p.i == q.i && p.j == q.j; };
  pairs.erase(std::unique(pairs.begin(), pairs.end(), same), pairs.end());
  return pairs;
}

void check_length(const Mesh& mesh, const Pair& pair, double length) {
  if (positive(length)) return;
  const char* name = pair.kind == SpringKind::structural ? "edge "
                     : pair.kind == SpringKind::shear    ? "diagonal "
                                                         : "bending spring ";
  fail_at_face(mesh, pair.face,
               name + std::to_string(pair.i + 1) + "-" + std::to_string(pair.j + 1) + " has length " +
                   (length == 0 ? "zero, expected distinct positions"
                                : shown(length) + ", expected positions less far apart"));
}

}  // namespace

SpringNet make_net(const Grid& grid, const SpringMaterial& material) {
  check(grid, "grid");
  check(material, "material");
  const double mass = material.particle_mass.value_or(material.area_density * grid.spacing * grid.spacing);
  if (!positive(mass))
    throw InputError("grid", 0,
                     "each particle weighs " + shown(mass) + " kg, expected a positive finite mass");

  SpringNet net;
  net.mass.assign(static_cast<std::size_t>(grid.particles()), mass);
  net.rest.reserve(net.mass.size());
  for (int p = 0; p < grid.particles(); ++p) net.rest.push_back(grid.place(p));

  // The neighbours that come after a particle, in the order of their numbers.
  static constexpr struct {
    int rows, columns;
    SpringKind kind;
  } neighbours[] = {{0, 1, SpringKind::structural}, {0, 2, SpringKind::bending}, {1, -1, SpringKind::shear},
                    {1, 0, SpringKind::structural}, {1, 1, SpringKind::shear},   {2, 0, SpringKind::bending}};
  const auto kinds =
      std::ranges::count_if(neighbours, [&](const auto& to) { return of(material.stiffness, to.kind) > 0; });
  net.springs.reserve(net.mass.size() * static_cast<std::size_t>(kinds));
  for (int i = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j)
      for (const auto& to : neighbours) {
        const int row = i + to.rows, column = j + to.columns;
        if (row >= grid.rows || column < 0 || column >= grid.columns) continue;
        if (of(material.stiffness, to.kind) > 0)
          add_spring(net, i * grid.columns + j, row * grid.columns + column, to.kind, material);
      }
  return net;
}

SpringNet make_net(const Mesh& mesh, const SpringMaterial& material) {
  check(material, "material");
  check(mesh);
  SpringNet net;
  net.rest = mesh.vertices;
  const std::vector<Pair> pairs = joined_pairs(mesh, material.stiffness);
  net.springs.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    add_spring(net, pair.i, pair.j, pair.kind, material);
    check_length(mesh, pair, net.springs.back().rest_length);
  }
  net.mass = particle_masses(mesh, material);
  return net;
}

void check(const Grid& grid, const std::string& source, long line) {
  const auto particles = static_cast<std::int64_t>(grid.rows) * grid.columns;
  if (grid.rows < 1 || grid.columns < 1 || particles > max_particles)
    throw InputError(source, line,
                     "the grid is " + std::to_string(grid.rows) + " x " + std::to_string(grid.columns) +
                         ", expected at least 1 x 1 and at most " + std::to_string(max_particles) +
                         " particles");
  if (!(grid.spacing >= 1e-100 && grid.spacing <= 1e100))
    throw InputError(source, line,
                     "the spacing is " + shown(grid.spacing) +
                         " m, expected a positive length between 1e-100 and 1e100 m");
}

void check(const SpringMaterial& material, const std::string& source, long line) {
  const auto require = [&](bool good, const std::string& name, double value, const std::string& expected) {
    if (!good) throw InputError(source, line, name + " is " + shown(value) + ", expected " + expected);
  };
  require(positive(material.area_density), "area density", material.area_density,
          "a positive number of kg/m²");
  if (const auto& mass = material.particle_mass)
    require(positive(*mass), "particle mass", *mass, "a positive number of kg");
  for (const SpringKind kind : {SpringKind::structural, SpringKind::shear, SpringKind::bending}) {
    const std::string name = kind == SpringKind::structural ? "structural"
                             : kind == SpringKind::shear    ? "shear"
                                                            : "bending";
    const double k = of(material.stiffness, kind), d = of(material.damping, kind);
    require(k == 0 || positive(k), name + " stiffness", k, "zero or a positive number of N/m");
    require(d == 0 || positive(d), name + " damping", d, "zero or a positive number of N·s/m");
    require(d == 0 || k > 0, name + " damping", d, "zero, since without stiffness there are no such springs");
  }
}

}  // namespace springstab
