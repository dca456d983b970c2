// Solids made of springs: which particles of a mesh of tetrahedra are joined, how heavy they are, how stiff
// the springs are. A spring lies on every edge, and each tetrahedron has one along each of its four
// altitudes.
#pragma once

#include <optional>

#include "solvers/scene/altitude_springs.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// The two kinds of springs of a solid, with one number each.
struct PerSolidKind {
  double edge = 0, altitude = 0;
};

/// What the solid is made of. A stiffness of 0 means that there are no such springs.
struct SolidMaterial {
  double density = 1000;                  // [kg/m³]
  std::optional<double> particle_mass{};  // [kg], instead of the density
  PerSolidKind stiffness{1000, 1000};     // [N/m]
  PerSolidKind damping{};                 // axial [N·s/m]
};

/// Particles at rest and the springs between them: one per edge, sorted by its particles, and four altitudes
/// per tetrahedron.
struct TetSolid {
  std::vector<Eigen::Vector3d> rest;  // [m]
  std::vector<double> mass;           // [kg]
  std::vector<Spring> edges;
  std::vector<Altitude> altitudes;
  SolidMaterial material;
};

/// A quarter of each tetrahedron's weight goes to each corner. Altitudes count positive from the side that
/// the apex is on in the mesh, however the tetrahedron is wound. Throws InputError, with the mesh's file and
/// line, for a mesh without tetrahedra, an edge outside 1e-60 to 1e60 m, a tetrahedron without volume (less
/// than 1e-12 of its longest edge cubed), a vertex without a tetrahedron, and a particle whose weight
/// underflows or overflows.
TetSolid make_solid(const TetMesh& mesh, const SolidMaterial& material);

/// Throws InputError unless densities and masses are positive, stiffness and damping not negative, all
/// finite, and nothing is damped that has stiffness 0.
void check(const SolidMaterial& material, const std::string& source, long line = 0);

/// The terms of a solid in a scene whose numbers of the particles are number[i], free ones first,
/// `free_count` of them. Springs between pinned particles alone and terms without springs are left out.
SceneTerms make_terms(const TetSolid& solid, const std::vector<int>& number, int free_count);

}  // namespace springstab
