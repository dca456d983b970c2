#include "solvers/scene/rest_coordinates.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace springstab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

template <class V>
bool span_area(const V& a, const V& b) {
  const double longest_squared = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
  double doubled;
  if constexpr (V::RowsAtCompileTime == 3) {
    doubled = a.cross(b).norm();
  } else {
    doubled = std::abs(a.x() * b.y() - a.y() * b.x());
  }
  return doubled / 2 > 1e-12 * longest_squared;
}

/// Two orthogonal unit vectors.
struct Frame {
  Vector3d u, v;

  Vector2d coordinates(const Vector3d& x) const { return {u.dot(x), v.dot(x)}; }
};

/// The frame of a plane with u along the projection of a direction that is not normal to it. v points to
/// where the largest of its components is positive.
Frame frame(const Vector3d& unit_normal, const Vector3d& direction) {
  const Vector3d u = (direction - unit_normal.dot(direction) * unit_normal).normalized();
  Vector3d v = unit_normal.cross(u);
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  return {u, v[largest] < 0 ? Vector3d(-v) : v};
}

/// The frame of the plane that all vertices lie in, if there is one.
std::optional<Frame> plane_of(const Mesh& mesh) {
  Vector3d mean(0, 0, 0);
  for (const Vector3d& x : mesh.vertices) mean += x / static_cast<double>(mesh.vertices.size());
  double farthest = 0;
  for (const Vector3d& x : mesh.vertices) farthest = std::max(farthest, (x - mean).norm());
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vector3d& x : mesh.vertices) {
    const Vector3d d = (x - mean) / farthest;
    moments += d * d.transpose();
  }
  const Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors().col(0);
  for (const Vector3d& x : mesh.vertices)
    if (std::abs(normal.dot(x - mean)) > 1e-9 * farthest) return std::nullopt;
  int axis = 0;  // the longest projection is that of the axis least along the normal
  for (int other = 1; other < 3; ++other)
    if (std::abs(normal[other]) < std::abs(normal[axis]) - 1e-9) axis = other;
  return frame(normal, Vector3d::Unit(axis));
}

TriangleUv own_plane(const std::array<Vector3d, 3>& x) {
  const Vector3d normal = (x[1] - x[0]).normalized().cross((x[2] - x[0]).normalized()).normalized();
  const bool along_x = normal.cross(Vector3d::UnitX()).norm() >= 1e-3;
  const Frame own = frame(normal, along_x ? Vector3d::UnitX() : Vector3d::UnitZ());
  return {Vector2d(0, 0), own.coordinates(x[1] - x[0]), own.coordinates(x[2] - x[0])};
}

std::vector<TriangleUv> own_planes(const Mesh& mesh, const std::vector<FaceTriangle>& triangles) {
  std::vector<TriangleUv> uv;
  for (const FaceTriangle& t : triangles) uv.push_back(own_plane(positions(mesh, t)));
  return uv;
}

double total_area(const std::vector<TriangleUv>& triangles) {
  double sum = 0;
  for (const TriangleUv& uv : triangles) sum += area(uv);
  return sum;
}

std::vector<TriangleUv> in_plane(const Mesh& mesh, const std::vector<FaceTriangle>& triangles,
                                 const Frame& plane) {
  std::vector<TriangleUv> all;
  for (const FaceTriangle& t : triangles) {
    const auto x = positions(mesh, t);
    all.push_back({Vector2d(0, 0), plane.coordinates(x[1] - x[0]), plane.coordinates(x[2] - x[0])});
  }
  return all;
}

// --- by the texture coordinates ---

long line_of(const Mesh& mesh, int face) {
  return mesh.face_line.empty() ? 0 : mesh.face_line[static_cast<std::size_t>(face)];
}

/// The largest factor by which a length of the triangle, x being affine in (u, v), differs from the map's.
double strain(const std::array<Vector3d, 3>& x, const TriangleUv& uv) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << x[1] - x[0], x[2] - x[0];
  Eigen::Matrix2d mapped;
  mapped << uv[1] - uv[0], uv[2] - uv[0];
  const Eigen::Matrix<double, 3, 2> gradient = sides * mapped.inverse();
  if (!gradient.allFinite()) return std::numeric_limits<double>::infinity();
  const Vector2d sigma = Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>>(gradient).singularValues();
  return std::max(sigma[0], 1 / sigma[1]);
}

/// In units of the file. `map.line` is that of the first triangle that has no area there.
std::vector<TriangleUv> textured(const Mesh& mesh, const std::vector<FaceTriangle>& triangles,
                                 TextureMap& map) {
  std::vector<TriangleUv> all;
  for (const FaceTriangle& t : triangles) {
    TriangleUv uv;
    for (int c = 0; c < 3; ++c) uv[c] = mesh.corner_uv[t.corners[c]];
    if (!span_area<Vector2d>(uv[1] - uv[0], uv[2] - uv[0])) {
      map.line = line_of(mesh, t.face);
      return {};
    }
    all.push_back(uv);
  }
  return all;
}

void measure(const Mesh& mesh, const std::vector<FaceTriangle>& triangles, const std::vector<TriangleUv>& uv,
             TextureMap& map) {
  map.triangles = static_cast<int>(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double factor = strain(positions(mesh, triangles[t]), uv[t]);
    map.strained += factor > straining_factor;
    if (!(factor > (1 + 1e-9) * map.largest_factor)) continue;  // the first of equal ones
    map.largest_factor = factor;
    map.line = line_of(mesh, triangles[t].face);
  }
}

}  // namespace

std::vector<FaceTriangle> fans(const Mesh& mesh) {
  std::vector<FaceTriangle> triangles;
  for (int f = 0; f < mesh.faces(); ++f)
    for (int k = mesh.face_offsets[f] + 1; k + 1 < mesh.face_offsets[f + 1]; ++k)
      triangles.push_back({{mesh.face_offsets[f], k, k + 1}, f});
  return triangles;
}

std::array<Vector3d, 3> positions(const Mesh& mesh, const FaceTriangle& t) {
  std::array<Vector3d, 3> x;
  for (int c = 0; c < 3; ++c) x[c] = mesh.vertices[mesh.face_vertices[t.corners[c]]];
  return x;
}

bool has_area(const Vector3d& a, const Vector3d& b) { return span_area(a, b); }

double area(const TriangleUv& uv) {
  const Vector2d a = uv[1] - uv[0], b = uv[2] - uv[0];
  return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
}

RestCoordinates rest_coordinates(const Mesh& mesh, const std::vector<FaceTriangle>& triangles,
                                 std::optional<double> texture_unit) {
  if (const std::optional<Frame> plane = plane_of(mesh))
    return {in_plane(mesh, triangles, *plane), RestShape::plane};
  RestCoordinates faces{own_planes(mesh, triangles), RestShape::faces};
  if (mesh.corner_uv.size() != mesh.face_vertices.size()) return faces;
  TextureMap& map = faces.map.emplace();
  std::vector<TriangleUv> uv = textured(mesh, triangles, map);
  if (uv.empty()) return faces;
  map.area_unit = std::sqrt(total_area(faces.uv) / total_area(uv));
  map.unit = texture_unit.value_or(map.area_unit);
  for (TriangleUv& triangle : uv)
    for (Vector2d& point : triangle) point *= map.unit;
  measure(mesh, triangles, uv, map);
  return {std::move(uv), RestShape::texture, map};
}

}  // namespace springstab
