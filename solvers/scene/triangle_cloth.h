// Cloth made of triangles after Baraff and Witkin: which particles form a triangle or a hinge, where they lie
// in the cloth at rest, how heavy they are. Turns a grid or a polygon mesh plus a material into masses and
// elements, and those into the terms of a scene.
//
// Polygons become triangles as a fan from their first corner (so a quad is split between its first and third
// corner, and polygons should be convex); the cell of a grid along one of its diagonals (Diagonals).
//
// Where a triangle lies in the cloth's own coordinates (u, v) [m]: on a grid, u = x along a row, v = z from
// row to row; on a mesh, see rest_coordinates.h.
#pragma once

#include <memory>
#include <optional>

#include "solvers/scene/hinge_angles.h"
#include "solvers/scene/mesh.h"
#include "solvers/scene/rest_coordinates.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/stretch_shear.h"

namespace springstab {

/// One number for each condition of the cloth.
struct PerCondition {
  double stretch_u = 0, stretch_v = 0, shear = 0, bending = 0;

  PerTriangleCondition in_plane() const { return {stretch_u, stretch_v, shear}; }
  bool any_in_plane() const { return stretch_u > 0 || stretch_v > 0 || shear > 0; }
};

/// What the cloth is made of. Where the stiffness of stretch and shear is 0 there are no triangles, where
/// that of bending is 0 no hinges.
struct ClothMaterial {
  double area_density = 0.2;                      // [kg/m²]
  std::optional<double> particle_mass{};          // [kg], instead of the area density
  PerCondition stiffness{1000, 1000, 100, 1e-5};  // stretch and shear [N/m], bending [N·m]
  PerCondition damping{};                         // stretch and shear [N·s/m], bending [N·m·s]
  AreaScaling scaling = AreaScaling::continuum;   // the original one: stretch and shear in N/m³ and N·s/m³
  RestStretch rest_stretch{};
  std::optional<double> texture_unit{};  // [m]; where absent, the one that gives the mesh its area
};

/// Particles at rest and the elements between them. A hinge's angle at rest is the mesh's, and 0 (or π, where
/// it is folded) for a mesh in a plane. Every two triangles at an edge form a hinge, however they are wound,
/// unless they have the same corners.
struct TriangleCloth {
  std::vector<Eigen::Vector3d> rest;  // [m]
  std::vector<double> mass;           // [kg]
  std::vector<RestTriangle> triangles;
  std::vector<Hinge> hinges;
  ClothMaterial material;
  RestShape rest_shape = RestShape::plane;
  std::optional<TextureMap> texture_map{};
};

/// Every particle weighs area_density · spacing². Throws InputError where `check` does, for a grid without a
/// cell or with a spacing outside 1e-60 to 1e60 m (the energies have its fourth power), and for a particle
/// whose weight underflows or overflows.
TriangleCloth make_cloth(const Grid& grid, const ClothMaterial& material);

/// A third of each triangle's weight, its area in (u, v) times the density, goes to each corner. Throws
/// InputError, with the mesh's file and line, where check(mesh) does, for a triangle without area or with a
/// side outside 1e-60 to 1e60 m, and for a particle whose weight underflows or overflows.
TriangleCloth make_cloth(const Mesh& mesh, const ClothMaterial& material);

/// Throws InputError unless densities, masses, rest stretches and the texture unit are positive, stiffness
/// and damping not negative, all finite, and nothing is damped that has stiffness 0.
void check(const ClothMaterial& material, const std::string& source, long line = 0);

/// The terms of a cloth in a scene whose numbers of the particles are number[i], free ones first,
/// `free_count` of them. Elements between pinned particles alone and terms without elements or coefficients
/// are left out.
SceneTerms make_terms(const TriangleCloth& cloth, const std::vector<int>& number, int free_count);

}  // namespace springstab
