// Cloth made of springs: which particles are joined, how heavy they are, how stiff the springs are.
// Turns a grid or a polygon mesh plus a material into masses and a list of springs; knows no forces.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
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
  double area_density = 0.2;              // [kg/m²]
  std::optional<double> particle_mass{};  // [kg], instead of the area density
  PerKind stiffness{200, 100, 20};        // [N/m]
  PerKind damping{};                      // axial damping [N·s/m]
};

/// The largest grid: its springs and matrix already take tens of gigabytes.
inline constexpr int max_particles = 20'000'000;

/// How triangles divide a grid's cells: each along the diagonal from particle (i, j) to (i+1, j+1), or where
/// i + j is odd along the other one, so that no direction is preferred.
enum class Diagonals { uniform, alternating };

/// rows × columns particles; particle i·columns + j rests at (j·spacing, 0, i·spacing).
struct Grid {
  int rows = 0;
  int columns = 0;
  double spacing = 0.025;                    // [m]
  Diagonals diagonals = Diagonals::uniform;  // of triangles; springs lie on both

  int particles() const { return rows * columns; }
  /// Where a particle rests [m].
  Eigen::Vector3d place(int particle) const {
    return {particle % columns * spacing, 0, particle / columns * spacing};
  }
};

/// A damped Hookean spring between two particles, i < j.
struct Spring {
  int i, j;
  double stiffness;    // k_s [N/m]
  double damping;      // k_d [N·s/m], along the axis
  double rest_length;  // l0 [m]
};

/// Particles at rest and the springs between them, sorted by (i, j): one spring per pair.
struct SpringNet {
  std::vector<Eigen::Vector3d> rest;  // [m]
  std::vector<double> mass;           // [kg]
  std::vector<Spring> springs;
};

/// A net on a grid: every particle weighs area_density · spacing². Structural springs join neighbours, shear
/// springs both diagonals of each cell, bending springs particles i and i+2 along rows and columns.
/// Throws InputError where `check` does, and for a particle whose weight underflows or overflows.
SpringNet make_net(const Grid& grid, const SpringMaterial& material);

/// A net on a polygon mesh: each face's weight is shared equally by its vertices. Structural springs lie on
/// the edges; shear springs on the diagonals (i, i+2) of faces with four or more corners. Bending: for each
/// pair of faces at an edge and each end of that edge, one spring joins the end's next neighbours in the two
/// faces. For two triangles that is the pair of opposite vertices, for two quads the particles i-1 and i+1 of
/// the row through that end; so a quad mesh of a grid gets the grid's springs.
///
/// One spring per pair of particles: structural before shear before bending. A fold whose two neighbours are
/// already joined is held by that spring, which measures the same distance; a second one would only add to
/// the in-plane stiffness. Kinds of stiffness 0 are absent and hold nothing; two faces that share the
/// neighbour itself (a vertex of valence two) have no such spring.
///
/// Throws InputError, with the mesh's file and line, for an empty mesh, a coordinate that is not finite, a
/// face with fewer than three corners, a repeated or unknown one, a vertex without a face or with faces of
/// zero area only (unless particle_mass says its weight), or a spring of length zero.
SpringNet make_net(const Mesh& mesh, const SpringMaterial& material);

/// Throws InputError unless the grid has 1 to max_particles particles at a spacing of 1e-100 to 1e100 m (so
/// that areas are positive and finite too).
void check(const Grid& grid, const std::string& source, long line = 0);

/// Throws InputError unless densities and masses are positive, stiffness and damping not negative, all
/// finite, and nothing is damped that has stiffness 0.
void check(const SpringMaterial& material, const std::string& source, long line = 0);

}  // namespace springstab
