#include "solvers/scene/tet_solid.h"

#include <algorithm>
#include <cmath>

#include "solvers/io/input_error.h"
#include "solvers/scene/quantities.h"
#include "solvers/scene/springs.h"

namespace springstab {
namespace {

constexpr double shortest_edge = 1e-60, longest_edge = 1e60;  // [m]
constexpr double flat_volume = 1e-12;                         // volume over the longest edge cubed

/// The volume [m³], never without; fails at the tetrahedron's line.
double checked_volume(const TetMesh& mesh, int t) {
  std::string name = "tetrahedron ";
  double longest = 0;
  for (int c = 0; c < 4; ++c) {
    name += (c ? "-" : "") + std::to_string(mesh.tets[t][c] + 1);
    for (int d = 0; d < c; ++d) {
      const double length = (mesh.vertices[mesh.tets[t][c]] - mesh.vertices[mesh.tets[t][d]]).norm();
      if (!(length >= shortest_edge && length <= longest_edge))
        fail_at_tet(mesh, t,
                    "a tetrahedron has an edge of " + shown(length) +
                        " m, expected a length between 1e-60 and 1e60 m");
      longest = std::max(longest, length);
    }
  }
  const double volume = std::abs(mesh.six_volumes(t)) / 6;
  if (!(volume > flat_volume * longest * longest * longest))
    fail_at_tet(
        mesh, t,
        name + " (vertices in the file's order) has no volume, expected corners that are not in a plane");
  return volume;
}

std::vector<Spring> edges_of(const TetMesh& mesh, const SolidMaterial& material) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& tet : mesh.tets)
    for (int c = 0; c < 4; ++c)
      for (int d = 0; d < c; ++d) pairs.push_back(std::minmax({tet[c], tet[d]}));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<Spring> springs;
  for (const auto& [i, j] : pairs)
    springs.push_back(
        {i, j, material.stiffness.edge, material.damping.edge, (mesh.vertices[j] - mesh.vertices[i]).norm()});
  return springs;
}

std::vector<Altitude> altitudes_of(const TetMesh& mesh) {
  static constexpr int corners[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}};
  std::vector<Altitude> altitudes;
  altitudes.reserve(4 * mesh.tets.size());
  for (const auto& tet : mesh.tets)
    for (const auto& order : corners) {
      Altitude a{{tet[order[0]], tet[order[1]], tet[order[2]], tet[order[3]]}};
      const auto& v = mesh.vertices;
      a.rest = altitude({v[a.particles[0]], v[a.particles[1]], v[a.particles[2]], v[a.particles[3]]});
      if (a.rest < 0) {
        std::swap(a.particles[2], a.particles[3]);
        a.rest = -a.rest;
      }
      altitudes.push_back(a);
    }
  return altitudes;
}

}  // namespace

TetSolid make_solid(const TetMesh& mesh, const SolidMaterial& material) {
  check(material, "material");
  if (mesh.tets.empty())
    throw InputError(mesh.source, 0, "the mesh has no tetrahedra, expected at least one");
  TetSolid solid;
  solid.material = material;
  solid.rest = mesh.vertices;
  solid.mass.assign(mesh.vertices.size(), 0);
  for (int t = 0; t < static_cast<int>(mesh.tets.size()); ++t) {
    const double share = material.density * checked_volume(mesh, t) / 4;
    for (const int v : mesh.tets[t]) solid.mass[v] += share;
  }
  for (std::size_t v = 0; v < solid.mass.size(); ++v) {
    if (!positive(solid.mass[v]))
      throw InputError(mesh.source, v < mesh.vertex_line.size() ? mesh.vertex_line[v] : 0,
                       "vertex " + std::to_string(v + 1) + " has a mass of " + shown(solid.mass[v]) +
                           " kg from the volume of its tetrahedra, expected a positive finite one");
    if (material.particle_mass) solid.mass[v] = *material.particle_mass;
  }
  if (material.stiffness.edge > 0) solid.edges = edges_of(mesh, material);
  if (material.stiffness.altitude > 0) solid.altitudes = altitudes_of(mesh);
  return solid;
}

void check(const SolidMaterial& material, const std::string& source, long line) {
  const auto require = [&](bool good, const std::string& name, double value, const std::string& expected) {
    if (!good) throw InputError(source, line, name + " is " + shown(value) + ", expected " + expected);
  };
  require(positive(material.density), "density", material.density, "a positive number of kg/m³");
  if (const auto& mass = material.particle_mass)
    require(positive(*mass), "particle mass", *mass, "a positive number of kg");
  const struct {
    std::string name;
    double stiffness, damping;
  } kinds[] = {{"edge", material.stiffness.edge, material.damping.edge},
               {"altitude", material.stiffness.altitude, material.damping.altitude}};
  for (const auto& [name, k, d] : kinds) {
    require(k == 0 || positive(k), name + " stiffness", k, "zero or a positive number of N/m");
    require(d == 0 || positive(d), name + " damping", d, "zero or a positive number of N·s/m");
    require(d == 0 || k > 0, name + " damping", d, "zero, since without stiffness there are no such springs");
  }
}

SceneTerms make_terms(const TetSolid& solid, const std::vector<int>& number, int free_count) {
  SpringNet edges;
  edges.springs = solid.edges;
  SceneTerms terms = make_terms(edges, number, free_count);
  std::vector<Altitude> altitudes;
  for (Altitude a : solid.altitudes) {
    for (int& p : a.particles) p = number[p];
    if (*std::ranges::min_element(a.particles) < free_count) altitudes.push_back(a);
  }
  if (altitudes.empty()) return terms;
  const auto shared = std::make_shared<Altitudes>(altitudes, free_count);
  terms.elastic.push_back(std::make_unique<AltitudeSprings>(shared, solid.material.stiffness.altitude));
  if (solid.material.damping.altitude > 0)
    terms.damping.push_back(std::make_unique<AltitudeDamping>(shared, solid.material.damping.altitude));
  return terms;
}

}  // namespace springstab
