// What stands in the way of a scene's particles: half-spaces and balls, at rest or in uniform motion.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace springstab {

/// All that lies on the other side than the normal points to, which has unit length.
struct Plane {
  Eigen::Vector3d point, normal;  // [m], 1
};

struct Sphere {
  Eigen::Vector3d center;  // [m]
  double radius;           // [m]
};

/// Where its shape says at t = 0, and u t further at t.
struct Obstacle {
  std::variant<Plane, Sphere> shape;
  Eigen::Vector3d velocity{0, 0, 0};  // u [m/s]
};

/// The distance of a place from the obstacle, negative inside [m], its gradient n, a unit vector, and its
/// Hessian κ (I - nnᵀ). As a function of the place it is convex: it grows at least as the gradient says.
struct Gap {
  double gap;
  Eigen::Vector3d normal;
  double curvature;  // κ [1/m]
};
Gap gap_at(const Obstacle& obstacle, const Eigen::Vector3d& x, double t);

/// The numbers of all places that are at most that distance from the obstacle, and hardly any others: for
/// less than the gaps.
void list_near(const Obstacle& obstacle, std::span<const Eigen::Vector3d> places, double t, double distance,
               std::vector<int>& near);

/// Whether x + s w comes inside the obstacle as it is at t, in 0 <= s <= 1.
bool path_enters(const Obstacle& obstacle, double t, const Eigen::Vector3d& x, const Eigen::Vector3d& w,
                 double thickness);

bool is_flat(const Obstacle& obstacle);

/// How far from the origin its numbers reach, for the rounding of places [m].
double extent_of(const Obstacle& obstacle);

/// What of a cloth is in which obstacle, and how deep [m].
struct Intersection {
  std::size_t obstacle;
  int index;  // of the particle or face
  double depth;
};

/// The first particle that is nearer to an obstacle than `thickness` at t = 0, beyond what is rounding of
/// places given in decimals. Nothing where all are apart.
std::optional<Intersection> first_particle_inside(std::span<const Obstacle> obstacles, double thickness,
                                                  std::span<const Eigen::Vector3d> particles);
/// The first face of which any place is in an obstacle at t = 0, likewise; faces are numbers of `places`.
std::optional<Intersection> first_face_inside(std::span<const Obstacle> obstacles,
                                              std::span<const Eigen::Vector3d> places,
                                              std::span<const std::vector<int>> faces);

}  // namespace springstab
