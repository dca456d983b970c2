#include "experiments/report/obstacle_faces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace springstab {
namespace {

using Corner = Eigen::Vector3d;

class FacesInSight {
 public:
  FacesInSight(const Eigen::AlignedBox3d& sight, double size) : sight_(sight), size_(size) {}

  // By halves of the longest edge.
  void add_triangle(const std::array<Corner, 3>& t) {
    Eigen::AlignedBox3d box;
    for (const Corner& corner : t) box.extend(corner);
    if (!sight_.intersects(box)) return;
    int longest = 0;
    const auto length = [&](int k) { return (t[(k + 1) % 3] - t[k]).norm(); };
    for (int k = 1; k < 3; ++k)
      if (length(k) > length(longest)) longest = k;
    if (!(length(longest) > std::numbers::sqrt2 * size_)) return add({t[0], t[1], t[2]});
    const Corner &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3], middle = (a + b) / 2;
    if (middle == a || middle == b) return add({t[0], t[1], t[2]});
    add_triangle({a, middle, c});
    add_triangle({middle, b, c});
  }

  // Squares whose middle is in sight.
  void add(const Plane& plane, const Eigen::Vector3d& shift) {
    const Corner middle = sight_.center();
    const Corner foot = middle - plane.normal.dot(middle - plane.point - shift) * plane.normal;
    const Eigen::Vector3d u = size_ * plane.normal.unitOrthogonal(), w = plane.normal.cross(u);
    const int count = static_cast<int>(std::ceil(sight_.diagonal().norm() / 2 / size_));
    for (int i = -count; i < count; ++i)
      for (int j = -count; j < count; ++j) {
        const Corner at = foot + i * u + j * w;
        if (sight_.contains(Corner(at + (u + w) / 2))) add({at, at + u, at + u + w, at + w});
      }
  }

  // What lies between these angles from the upward axis and around it, by halves.
  void add(const Sphere& ball, const Eigen::Vector3d& shift, const std::array<double, 2>& down,
           const std::array<double, 2>& around) {
    const auto at = [&](double theta, double phi) -> Corner {
      const double s = std::sin(theta);
      return ball.center + shift +
             ball.radius * Corner(s * std::cos(phi), std::cos(theta), s * std::sin(phi));
    };
    const double theta = (down[0] + down[1]) / 2, phi = (around[0] + around[1]) / 2,
                 high = ball.radius * (down[1] - down[0]),
                 wide =
                     ball.radius * (around[1] - around[0]) * std::max(std::sin(down[0]), std::sin(down[1]));
    if (high <= size_ && sight_.exteriorDistance(at(theta, phi)) > high + wide) return;
    if (high > size_) {
      add(ball, shift, {down[0], theta}, around);
      add(ball, shift, {theta, down[1]}, around);
    } else if (wide > size_) {
      add(ball, shift, down, {around[0], phi});
      add(ball, shift, down, {phi, around[1]});
    } else {
      add({at(down[0], around[0]), at(down[1], around[0]), at(down[1], around[1]), at(down[0], around[1])});
    }
  }

  PlacedFaces take() { return std::move(all_); }

 private:
  void add(const std::vector<Corner>& corners) {
    std::vector<int> face;
    for (const Corner& corner : corners) {
      face.push_back(static_cast<int>(all_.places.size()));
      all_.places.push_back(corner);
    }
    all_.faces.push_back(std::move(face));
  }

  Eigen::AlignedBox3d sight_;
  double size_;
  PlacedFaces all_;
};

}  // namespace

PlacedFaces obstacle_faces(const Contact& contact, double t, const Eigen::AlignedBox3d& sight, double size) {
  FacesInSight faces(sight, size);
  for (const Obstacle& obstacle : contact.obstacles) {
    const Eigen::Vector3d shift = t * obstacle.velocity;
    if (const auto* plane = std::get_if<Plane>(&obstacle.shape))
      faces.add(*plane, shift);
    else
      faces.add(std::get<Sphere>(obstacle.shape), shift, {0, std::numbers::pi}, {0, 2 * std::numbers::pi});
  }
  for (const MeshObstacle& mesh : contact.meshes)
    for (const std::array<int, 3>& triangle : mesh.triangles) {
      std::array<Corner, 3> corners;
      for (int k = 0; k < 3; ++k) corners[k] = mesh.vertices[triangle[k]] + t * mesh.velocity;
      faces.add_triangle(corners);
    }
  return faces.take();
}

Eigen::AlignedBox3d box_of_obstacles(const Contact& contact, double t) {
  Eigen::AlignedBox3d box;
  for (const Obstacle& obstacle : contact.obstacles)
    if (const auto* ball = std::get_if<Sphere>(&obstacle.shape)) {
      const Eigen::Vector3d center = ball->center + t * obstacle.velocity;
      box.extend(Eigen::AlignedBox3d(center.array() - ball->radius, center.array() + ball->radius));
    }
  for (const MeshObstacle& mesh : contact.meshes)
    for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex + t * mesh.velocity);
  return box;
}

}  // namespace springstab
