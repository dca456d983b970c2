// What of a cloth's surface touches itself and meshes at rest: places nearer to each other than the
// thickness, each counted once. Of a vertex v and the faces that it is no corner of,
//     Σ E(v, face) - Σ E(v, edge between two of them) + Σ E(v, vertex within them)
// counts what is closest to v once wherever that is on an edge or a vertex, which are of several faces
// (inclusion and exclusion: a part of the surface counts 1 - Σ of the counts of those it is part of). It goes
// over from face to face without a jump of its gradient, for a distance from a convex part has none. Of
// edges, those that come closest within both (touch.h).
#pragma once

#include <span>
#include <vector>

#include "solvers/contact/contact.h"
#include "solvers/contact/surface_pairs.h"
#include "solvers/contact/touch.h"
#include "solvers/scene/elements.h"
#include "solvers/system.h"

namespace springstab {

class SurfaceTouches {
 public:
  /// Throws std::invalid_argument where the contact has no thickness or a mesh moves, and std::runtime_error
  /// where surfaces cannot be paired (surface_pairs.h).
  SurfaceTouches(const Contact& contact, int free_count, const ClothSurface& surface);

  /// Finds what touches where the particles are at x; the same places are not looked at again.
  void find(const ParticleField& x);
  void find(const Vector& x);

  // As found, in an order that is a function of the places alone.
  std::span<const Touch> touches() const { return touches_; }
  const Elements<4>& elements() const { return elements_; }
  FourPlaces places(const Touch& touch) const;
  /// Of all particles, as touches name them: free ones, pinned ones, the vertices of meshes.
  ParticleField field() const;

  int free_count() const { return free_count_; }
  double thickness() const { return thickness_; }

  /// The contacts at a particle, the most there are: Σ c s |w| of those with c > 0.
  double most_contacts() const;

 private:
  /// A part of a surface that is closest to a vertex.
  struct Feature {
    std::array<int, 3> key;      // its particles ascending, -1 for none
    std::array<int, 3> corners;  // of a face that has it, its own first
    int size, count;
  };
  using FaceContacts = std::span<const SurfaceContact>;

  void find_all();
  void add_vertex(FaceContacts faces);
  void add_closest_of_face(const SurfaceContact& face);
  void add_edges(int vertex, FaceContacts faces);
  void add_corners(int vertex, FaceContacts faces);
  void add_closest_of_edge(int vertex, const std::array<int, 3>& corners, int count);
  void add_feature(const std::array<int, 3>& corners, int size, int count);
  void add_edge_and_edge(const SurfaceContact& edges);

  double thickness_;
  int free_count_;
  std::vector<Eigen::Vector3d> places_;
  std::size_t pinned_;
  std::vector<SurfacePairs> pairs_;
  std::vector<Touch> touches_;
  Elements<4> elements_;
  std::vector<Feature> features_;            // closest to one vertex
  std::vector<std::array<int, 3>> edges_;    // of its faces: the smaller number, the larger, the third corner
  std::vector<std::array<int, 3>> corners_;  // of its faces, each first
  std::vector<int> ends_;                    // of its edges, ascending
  bool has_found_ = false;
};

}  // namespace springstab
