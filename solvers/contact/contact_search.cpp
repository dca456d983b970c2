#include "solvers/contact/contact_search.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace springstab {
namespace {

constexpr double nearest_allowed = 0.5;  // of the thickness; what is nearer counts as passing
constexpr double skin_of_thickness = 1;  // how far surfaces are looked for beyond the thickness

std::vector<std::array<int, 3>> shifted(std::vector<std::array<int, 3>> triangles, int by) {
  for (auto& triangle : triangles)
    for (int& corner : triangle) corner += by;
  return triangles;
}

double bound_at_end(const PairContact& c, double gap, const Places& x, const Places& y) {
  return std::min(0., c.normal.dot(parting(c, y) - parting(c, x)) - gap);
}

double bound_at_start(double gap) { return -std::max(gap, 0.); }

PairContact pair_contact(const SurfaceContact& c) { return {c.particles, c.weights, c.normal, 0}; }

}  // namespace

ContactSearch::ContactSearch(const Contact& contact, int free_count, const ClothSurface& surface)
    : contact_(contact), free_count_(free_count), start_(surface.pinned) {
  if (!(contact.thickness > 0))
    throw std::invalid_argument("the thickness is " + std::to_string(contact.thickness) +
                                " m, expected a positive one for surfaces");
  velocity_.assign(free_count + start_.size(), Eigen::Vector3d::Zero());
  std::vector<std::array<int, 3>> meshes;
  for (const MeshObstacle& mesh : contact.meshes) {
    const auto triangles = shifted(mesh.triangles, static_cast<int>(velocity_.size()));
    meshes.insert(meshes.end(), triangles.begin(), triangles.end());
    start_.insert(start_.end(), mesh.vertices.begin(), mesh.vertices.end());
    velocity_.resize(velocity_.size() + mesh.vertices.size(), mesh.velocity);
  }
  placed_ = velocity_.size();
  for (const Obstacle& obstacle : contact.obstacles) {
    start_.push_back(Eigen::Vector3d::Zero());
    velocity_.push_back(obstacle.velocity);
  }
  const PairDistances distances{contact.thickness, skin_of_thickness * contact.thickness};
  const Surface cloth = make_surface(surface.triangles);
  if (contact.self) pairs_.emplace_back(cloth, free_count, distances);
  if (!meshes.empty()) pairs_.emplace_back(cloth, make_surface(meshes), free_count, distances);
}

void ContactSearch::place(const Vector& x, double t, Places& places) const {
  places.resize(nodes());
  const auto free = static_cast<std::size_t>(free_count_);
  for (std::size_t i = 0; i < free; ++i) places[i] = x.segment<3>(static_cast<Eigen::Index>(3 * i));
  for (std::size_t i = free; i < nodes(); ++i) places[i] = start_[i - free] + t * velocity_[i];
}

void ContactSearch::set_velocities(const Vector& v, Places& velocities) const {
  velocities = velocity_;
  for (int i = 0; i < free_count_; ++i) velocities[i] = v.segment<3>(3 * static_cast<Eigen::Index>(i));
}

void ContactSearch::advance(const Places& x, const Places& v, double h, double t, Places& y) const {
  y.resize(nodes());
  const auto free = static_cast<std::size_t>(free_count_);
  for (std::size_t i = 0; i < free; ++i) y[i] = x[i] + h * v[i];
  for (std::size_t i = free; i < nodes(); ++i) y[i] = start_[i - free] + t * velocity_[i];
}

std::span<const Entered> ContactSearch::entered(const Places& x, const Places& y, double t, double h,
                                                bool lands) {
  entered_.clear();
  in_step_.clear();
  for (SurfacePairs& pairs : pairs_) {
    in_step_.push_back(pairs.step(surface_places(x), surface_places(y), contact_.thickness));
    add_passing(in_step_.back().collisions, x, h, lands);
  }
  if (entered_.empty()) {
    for (const StepContacts& contacts : in_step_)
      for (const SurfaceContact& found : contacts.proximities) {
        PairContact c = pair_contact(found);
        const double gap = found.gap - contact_.thickness;
        c.bound = lands ? bound_at_end(c, gap, x, y) / h : 0;
        entered_.push_back({c, gap, gap < -nearest_allowed * contact_.thickness});
      }
  }
  add_obstacles(x, y, t, h, lands);
  found_ += static_cast<long>(entered_.size());
  return entered_;
}

void ContactSearch::add_passing(std::span<const SurfaceContact> collisions, const Places& x, double h,
                                bool lands) {
  for (const SurfaceContact& found : collisions) {
    PairContact c = pair_contact(found);
    const double gap = c.normal.dot(parting(c, x)) - contact_.thickness;
    c.bound = lands ? bound_at_start(gap) / h : 0;
    entered_.push_back({c, -contact_.thickness, true});
  }
}

// Of a step through a ball the end tells nothing; one along it may cut into the thickness.
void ContactSearch::add_obstacles(const Places& x, const Places& y, double t, double h, bool lands) {
  double longest = 0;
  for (int i = 0; i < free_count_; ++i) longest = std::max(longest, (y[i] - x[i]).squaredNorm());
  longest = std::sqrt(longest);
  for (std::size_t k = 0; k < contact_.obstacles.size(); ++k) {
    const Obstacle& obstacle = contact_.obstacles[k];
    list_near(k, y, t + h, longest + h * obstacle.velocity.norm());
    for (const int i : near_obstacle_) {
      const Gap at = gap_at(obstacle, y[i], t + h);
      const double gap = at.gap - contact_.thickness;
      if (gap < 0) {
        PairContact c = touch(k, i, at.normal);
        c.bound = lands ? bound_at_end(c, gap, x, y) / h : 0;
        entered_.push_back({c, gap, gap < -nearest_allowed * contact_.thickness});
        continue;
      }
      const Eigen::Vector3d way = y[i] - x[i] - h * obstacle.velocity;
      if (is_flat(obstacle) || gap > way.norm() ||
          !path_enters(obstacle, t, x[i], way, nearest_allowed * contact_.thickness))
        continue;
      const Gap from = gap_at(obstacle, x[i], t);
      PairContact c = touch(k, i, from.normal);
      c.bound = lands ? bound_at_start(from.gap - contact_.thickness) / h : 0;
      entered_.push_back({c, -contact_.thickness, true});
    }
  }
}

// The free particles that are less than the thickness and that from it, and hardly any others.
void ContactSearch::list_near(std::size_t obstacle, const Places& x, double t, double beyond_thickness) {
  springstab::list_near(contact_.obstacles[obstacle], {x.data(), static_cast<std::size_t>(free_count_)}, t,
                        contact_.thickness + beyond_thickness, near_obstacle_);
}

PairContact ContactSearch::touch(std::size_t obstacle, int particle, const Eigen::Vector3d& normal) const {
  const int other = static_cast<int>(placed_ + obstacle);
  return {{particle, other, other, other}, {1, -1, 0, 0}, normal, 0};
}

std::span<const Entered> ContactSearch::too_near(const Places& x, double t) {
  entered_.clear();
  const auto add = [&](PairContact c, double gap) {
    c.bound = -gap;
    entered_.push_back({c, gap, false});
  };
  for (SurfacePairs& pairs : pairs_)
    for (const SurfaceContact& found : pairs.proximities(surface_places(x), contact_.thickness))
      add(pair_contact(found), found.gap - contact_.thickness);
  for (std::size_t k = 0; k < contact_.obstacles.size(); ++k) {
    list_near(k, x, t, 0);
    for (const int i : near_obstacle_)
      if (const Gap at = gap_at(contact_.obstacles[k], x[i], t); at.gap < contact_.thickness)
        add(touch(k, i, at.normal), at.gap - contact_.thickness);
  }
  return entered_;
}

bool ContactSearch::collide(const Places& x, const Places& y) {
  return std::any_of(pairs_.begin(), pairs_.end(), [&](SurfacePairs& pairs) {
    return !pairs.collisions(surface_places(x), surface_places(y)).empty();
  });
}

}  // namespace springstab
