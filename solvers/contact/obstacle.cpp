#include "solvers/contact/obstacle.h"

#include <algorithm>

#include "solvers/contact/closest_places.h"

namespace springstab {
namespace {

constexpr double rounding_of_places = 1e-12;  // relative, of places given in decimals

Gap gap_of(const Plane& plane, const Eigen::Vector3d& x) {
  return {plane.normal.dot(x - plane.point), plane.normal, 0};
}

Gap gap_of(const Sphere& sphere, const Eigen::Vector3d& x) {
  const Eigen::Vector3d from = x - sphere.center;
  const double distance = from.norm();
  if (distance == 0) return {-sphere.radius, Eigen::Vector3d::UnitY(), 0};  // every direction leads out
  return {distance - sphere.radius, from / distance, 1 / distance};
}

bool is_near(const Plane& plane, const Eigen::Vector3d& x, double distance) {
  return gap_of(plane, x).gap <= distance;
}

bool is_near(const Sphere& sphere, const Eigen::Vector3d& x, double distance) {
  const double reach = sphere.radius + distance;
  return (x - sphere.center).squaredNorm() <= (1 + rounding_of_places) * reach * reach;
}

double size_of(const Plane& plane) { return plane.point.norm(); }
double size_of(const Sphere& sphere) { return sphere.center.norm() + sphere.radius; }

// The place of the segment from x to x + w that is nearest to c.
Eigen::Vector3d nearest_on_segment(const Eigen::Vector3d& x, const Eigen::Vector3d& w,
                                   const Eigen::Vector3d& c) {
  const double square = w.squaredNorm();
  return square > 0 ? x + std::clamp(w.dot(c - x) / square, 0., 1.) * w : x;
}

// How deep the innermost place of a face is, of a polygon as a fan of triangles. (In a half-space that is a
// corner.)
double depth_of(const Plane& plane, std::span<const Eigen::Vector3d> places, const std::vector<int>& face) {
  double depth = -gap_of(plane, places[face[0]]).gap;
  for (const int i : face) depth = std::max(depth, -gap_of(plane, places[i]).gap);
  return depth;
}

double depth_of(const Sphere& sphere, std::span<const Eigen::Vector3d> places, const std::vector<int>& face) {
  double depth = -gap_of(sphere, places[face[0]]).gap;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const FourPlaces center_and_face{sphere.center, places[face[0]], places[face[c - 1]], places[face[c]]};
    const ClosestPlaces closest = closest_places(PairKind::vertex_face, center_and_face);
    depth = std::max(depth, sphere.radius - closest.difference.norm());
  }
  return depth;
}

}  // namespace

Gap gap_at(const Obstacle& obstacle, const Eigen::Vector3d& x, double t) {
  const Eigen::Vector3d back = x - t * obstacle.velocity;
  return std::visit([&](const auto& shape) { return gap_of(shape, back); }, obstacle.shape);
}

void list_near(const Obstacle& obstacle, std::span<const Eigen::Vector3d> places, double t, double distance,
               std::vector<int>& near) {
  near.clear();
  const Eigen::Vector3d way = t * obstacle.velocity;
  std::visit(
      [&](const auto& shape) {
        for (std::size_t i = 0; i < places.size(); ++i)
          if (is_near(shape, places[i] - way, distance)) near.push_back(static_cast<int>(i));
      },
      obstacle.shape);
}

bool path_enters(const Obstacle& obstacle, double t, const Eigen::Vector3d& x, const Eigen::Vector3d& w,
                 double thickness) {
  const auto* sphere = std::get_if<Sphere>(&obstacle.shape);
  const Eigen::Vector3d innermost =
      sphere ? nearest_on_segment(x, w, sphere->center + t * obstacle.velocity) : x + w;
  return gap_at(obstacle, innermost, t).gap < thickness;
}

double extent_of(const Obstacle& obstacle) {
  return std::visit([](const auto& shape) { return size_of(shape); }, obstacle.shape);
}

bool is_flat(const Obstacle& obstacle) { return std::holds_alternative<Plane>(obstacle.shape); }

std::optional<Intersection> first_particle_inside(std::span<const Obstacle> obstacles, double thickness,
                                                  std::span<const Eigen::Vector3d> particles) {
  for (std::size_t k = 0; k < obstacles.size(); ++k)
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double depth = thickness - gap_at(obstacles[k], particles[i], 0).gap;
      if (depth > rounding_of_places * (extent_of(obstacles[k]) + particles[i].norm()))
        return Intersection{k, static_cast<int>(i), depth};
    }
  return std::nullopt;
}

std::optional<Intersection> first_face_inside(std::span<const Obstacle> obstacles,
                                              std::span<const Eigen::Vector3d> places,
                                              std::span<const std::vector<int>> faces) {
  for (std::size_t k = 0; k < obstacles.size(); ++k)
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const double depth = std::visit([&](const auto& shape) { return depth_of(shape, places, faces[f]); },
                                      obstacles[k].shape);
      if (depth > rounding_of_places * (extent_of(obstacles[k]) + places[faces[f][0]].norm()))
        return Intersection{k, static_cast<int>(f), depth};
    }
  return std::nullopt;
}

}  // namespace springstab
