// What comes close to what: vertices and faces, edges and edges, of a surface with itself or of one surface
// with another, at an instant (proximities) or on the way from one place to the next (collisions).
//
//     Surface cloth = make_surface(triangles);
//     SurfacePairs pairs(cloth, free_count, {.reach = 0.005, .skin = 0.005});
//     for (const SurfaceContact& c : pairs.proximities(x, 0.005)) …
//     for (const SurfaceContact& c : pairs.collisions(x, x_next)) …
//     const auto [collisions, proximities] = pairs.step(x, x_next, 0.005);  // both, at the end
//
// Places x of all particles, in meters, are one list: particles 0 … free_count - 1 are free to move, those
// after them are not: pinned ones, and the vertices of obstacles. Pairs that share a particle, and pairs
// without a free one, are left out. Pairs that may come closer than `reach` are kept while nothing is more
// than half the skin from where it was to be (kept_pairs.h), and are found again by a tree of boxes
// otherwise. What is returned does not depend on what was kept, and is sorted: it is a function of the places
// alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>

#include "solvers/contact/box_pairs.h"
#include "solvers/contact/closest_places.h"
#include "solvers/contact/first_impact.h"
#include "solvers/contact/surface.h"

namespace springstab {

/// A vertex and a face, weights 1, -b0, -b1, -b2, or an edge and an edge, weights a0, a1, -b0, -b1, where a
/// and b are >= 0 and have the sum 1: the two places that are closest. Some are 0 where these are on a
/// border.
struct SurfaceContact {
  std::array<int, 4> particles;
  std::array<double, 4> weights;  // w
  Eigen::Vector3d normal;         // n, a unit vector, from the second one to the first, as before the contact
  double gap;                     // n·Σ w x [m]; of collisions at the time of impact, 0 but for tolerance
  double time;                    // of impact, in [0, 1] of the step; 0 of proximities
  PairKind kind = PairKind::vertex_face;
};

/// Lists that the next call of whatever kind overwrites.
struct StepContacts {
  std::span<const SurfaceContact> collisions, proximities;
};

struct PairDistances {
  double reach;  // the largest distance that proximities are asked for [m]
  double skin;   // [m], positive
};

/// In all calls together.
struct PairCounts {
  long kept = 0;      // pairs of a vertex and a face or of two edges, in every call
  long tested = 0;    // those of them of which it was not clear that they are apart
  long rebuilds = 0;  // of what is kept
  long strays = 0;    // times that a few left their ways, and what they are near to was found anew
};

/// Needs has_embree() (box_pairs.h): the constructors throw std::runtime_error with `embree_is_missing` else.
class SurfacePairs {
 public:
  /// Of the surface with itself.
  SurfacePairs(Surface surface, int free_count, PairDistances distances);
  /// Of one surface with the other, which have no particle in common.
  SurfacePairs(Surface first, Surface second, int free_count, PairDistances distances);
  ~SurfacePairs();
  SurfacePairs(SurfacePairs&&) noexcept;
  SurfacePairs& operator=(SurfacePairs&&) noexcept;

  /// All pairs at most `distance` apart, in a list that the next call overwrites.
  std::span<const SurfaceContact> proximities(std::span<const Eigen::Vector3d> x, double distance);

  /// All pairs that meet while every particle moves uniformly from x0 to x1, with the first time they do,
  /// likewise. None is missed; one that does not quite meet is taken for one that does where it comes nearer
  /// than `collision_tolerance` times the pair's extent over the step. Pairs that touch at the start count as
  /// meeting unless they part.
  std::span<const SurfaceContact> collisions(std::span<const Eigen::Vector3d> x0,
                                             std::span<const Eigen::Vector3d> x1);

  /// Both in one go, for less: collisions(x0, x1) and proximities(x1, distance).
  StepContacts step(std::span<const Eigen::Vector3d> x0, std::span<const Eigen::Vector3d> x1,
                    double distance);

  const PairCounts& counts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace springstab
