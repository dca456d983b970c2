// Where the triangles of a mesh lie in the cloth's own coordinates (u, v), in metres:
// - on a mesh that lies in a plane (no vertex farther from it than 1e-9 of the distance of the farthest
//   vertex from their mean), u along that of the world's axes that has the longest projection to the plane
//   (the first of equal ones), projected; v in the plane at a right angle to it;
// - else by the texture coordinates, if every corner has them and they give every triangle an area;
// - else as the triangle is, with u along the projection of the x axis to its plane, or of the z axis where
//   that of x is shorter than 1/1000.
// A triangle without area is one with less than 1e-12 of the square of its longest side.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "solvers/scene/mesh.h"

namespace springstab {

/// Three corners of a face, as places in Mesh::face_vertices.
struct FaceTriangle {
  std::array<int, 3> corners;
  int face;
};

/// The faces as fans from their first corners.
std::vector<FaceTriangle> fans(const Mesh& mesh);

std::array<Eigen::Vector3d, 3> positions(const Mesh& mesh, const FaceTriangle& triangle);

/// Whether two sides of a triangle span an area.
bool has_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

using TriangleUv = std::array<Eigen::Vector2d, 3>;

/// [m²], of either orientation.
double area(const TriangleUv& uv);

enum class RestShape { plane, texture, faces };

/// A map strains a triangle when the mesh has a length in it that is more than this many times that in the
/// map, or that many times less. No fabric is cut like that: it tears at some ten percent, and maps that
/// lay a curved surface flat are off by less (1.24 at most on the published cloth that the tests read). At 2,
/// k0 has grown by 4, which no usual safety factor covers; and a length pressed to a half gives K the
/// transverse stiffness κ (1 - 1/½) = -κ, the cloth's own. Mirrored triangles are not strained: the energies
/// are of lengths and of the angle between u and v.
inline constexpr double straining_factor = 2;

/// What the texture coordinates are to a mesh that does not lie in a plane. Where they give a triangle no
/// area they are not used, and `line` alone is known.
struct TextureMap {
  double unit = 0;       // [m] of one unit of them: the one that was given or else area_unit
  double area_unit = 0;  // [m], with which the map has the mesh's area
  int triangles = 0, strained = 0;
  double largest_factor = 0;  // the largest of σ₁ and 1/σ₂ of all triangles, σ singular values of ∂x/∂(u, v)
  long line = 0;              // of the first face with the largest factor, or without area; 0 where unknown
};

struct RestCoordinates {
  std::vector<TriangleUv> uv;  // of the triangles [m]
  RestShape shape = RestShape::plane;
  std::optional<TextureMap> map{};  // none in a plane and where a corner has no coordinates
};

/// texture_unit [m]: of one unit of texture coordinates. The triangles have areas in space.
RestCoordinates rest_coordinates(const Mesh& mesh, const std::vector<FaceTriangle>& triangles,
                                 std::optional<double> texture_unit);

}  // namespace springstab
