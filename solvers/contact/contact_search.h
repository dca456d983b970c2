// What surfaces, planes and balls a step of all particles at once would enter, as contacts of nodes. Nodes
// are the free particles, the pinned ones, the vertices of meshes, and for each plane and ball one that
// stands for its motion.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "solvers/contact/contact.h"
#include "solvers/contact/coupled_impulses.h"
#include "solvers/contact/surface_pairs.h"
#include "solvers/system.h"

namespace springstab {

/// Of a pair that is nearer than the thickness at the end of a step, or that the step takes through each
/// other.
struct Entered {
  PairContact contact;
  double gap;   // beyond the thickness, at the end [m]
  bool passes;  // through each other, or nearer than half the thickness
};

using Places = std::vector<Eigen::Vector3d>;

class ContactSearch {
 public:
  /// Throws std::invalid_argument where the contact has no thickness, and std::runtime_error where surfaces
  /// cannot be paired (surface_pairs.h).
  ContactSearch(const Contact& contact, int free_count, const ClothSurface& surface);

  std::size_t nodes() const { return velocity_.size(); }
  int free_count() const { return free_count_; }

  /// Where all nodes are at the time t, and how fast: free ones as given.
  void place(const Vector& x, double t, Places& places) const;
  void set_velocities(const Vector& v, Places& velocities) const;
  /// Free nodes go to x + h v, others to where they are at t.
  void advance(const Places& x, const Places& v, double h, double t, Places& y) const;

  /// In the step of h from x, at the time t, to y: first what passes through each other, and only where
  /// nothing does what is too near at the end. Bounds are those of a velocity from x that lands (or, unless
  /// `lands`, of one that does not approach); none asks for more than not to approach. The next call
  /// overwrites the list. It is in the same order whatever was asked before.
  std::span<const Entered> entered(const Places& x, const Places& y, double t, double h, bool lands);
  /// What is too near at x, with bounds that part it to the thickness in a time of 1.
  std::span<const Entered> too_near(const Places& x, double t);
  /// Whether anything passes through each other.
  bool collide(const Places& x, const Places& y);
  /// In all lists together.
  long found() const { return found_; }

 private:
  std::span<const Eigen::Vector3d> surface_places(const Places& x) const { return {x.data(), placed_}; }
  void add_passing(std::span<const SurfaceContact> collisions, const Places& x, double h, bool lands);
  void add_obstacles(const Places& x, const Places& y, double t, double h, bool lands);
  void list_near(std::size_t obstacle, const Places& x, double t, double beyond_thickness);
  PairContact touch(std::size_t obstacle, int particle, const Eigen::Vector3d& normal) const;

  Contact contact_;
  int free_count_;
  std::size_t placed_;  // nodes that have a place
  Places start_;        // of nodes that are not free, at t = 0
  Places velocity_;     // of all nodes; zero of the free ones
  std::vector<SurfacePairs> pairs_;
  std::vector<StepContacts> in_step_;  // of each of them
  std::vector<int> near_obstacle_;
  std::vector<Entered> entered_;
  long found_ = 0;
};

}  // namespace springstab
