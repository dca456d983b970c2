// Cloth made of springs: which particles are joined, how heavy they are, how stiff the springs are.
// Turns a grid or a polygon mesh plus a material into masses and a list of springs; knows no forces.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// The three kinds of springs of a net, with one number each.
struct PerKind {
  double structural = 0;  // along edges
  double shear = 0;       // across the corners of a face
  double bending = 0;     // between next-but-one particles, across an edge
};

/// What the cloth is made of. A stiffness of 0 means that there are no such springs.
struct SpringMaterial {
  double area_density = 0.2;            // [kg/m²]
  std::optional<double> particle_mass;  // [kg], instead of the area density
  PerKind stiffness{200, 100, 20};      // [N/m]
  PerKind damping{};                    // axial damping [N·s/m]
};

/// rows × columns particles; particle i·columns + j rests at (j·spacing, 0, i·spacing).
struct Grid {
  int rows = 0;
  int columns = 0;
  double spacing = 0.025;  // [m]
};

/// A damped Hookean spring between two particles.
struct Spring {
  int i, j;
  double stiffness;    // k_s [N/m]
  double damping;      // k_d [N·s/m], along the axis
  double rest_length;  // l0 [m]
};

/// Particles at rest and the springs between them.
struct SpringNet {
  std::vector<Eigen::Vector3d> rest;  // [m]
  std::vector<double> mass;           // [kg]
  std::vector<Spring> springs;
};

/// A net on a grid: every particle weighs area_density · spacing². Structural springs join neighbours, shear
/// springs both diagonals of each cell, bending springs particles i and i+2 along rows and columns.
/// Throws InputError for an empty grid or a spacing that is not positive and finite.
SpringNet make_net(const Grid& grid, const SpringMaterial& material);

/// A net on a polygon mesh: each face's weight is shared equally by its vertices. Structural springs lie on the
/// edges; shear springs on the diagonals (i, i+2) of faces with four or more corners. Bending: for an edge shared
/// by two faces and each of its ends, one spring joins the end's next neighbours in the two faces. For two
/// triangles that is the pair of opposite vertices, for two quads the particles i-1 and i+1 of the row through
/// that end. Throws InputError, with the mesh's file and line, for an empty mesh, a vertex without a face,
/// a repeated corner, or a zero-length spring.
SpringNet make_net(const Mesh& mesh, const SpringMaterial& material);

/// Throws InputError unless densities and masses are positive, stiffness and damping not negative, all finite.
void check(const SpringMaterial& material, const std::string& source);

}  // namespace springstab
