// The pairs of vertices and faces, and of edges, that may come within reach of each other while ways are as
// foreseen (foreseen_ways.h), sorted; by a tree of boxes around the ways, or of the few that have left them
// by the boxes of all. And of these pairs those that are not clear: each has a direction in which it was
// apart, and is as long as no two places have come that much nearer to each other.
#pragma once

#include "solvers/contact/closest_places.h"
#include "solvers/contact/foreseen_ways.h"
#include "solvers/contact/pair_list.h"
#include "solvers/contact/surface_pairs.h"

namespace springstab {

/// Vertices and edges for which a triangle stands, so that each is looked for once: numbers of KeptPairs'
/// lists.
struct OwnFeatures {
  std::array<int, 3> vertices, edges;
  int vertex_count = 0, edge_count = 0;
};

class KeptPairs {
 public:
  using PlaceList = std::span<const Eigen::Vector3d>;

  /// Of `first` with itself, where `second` is empty; see SurfacePairs.
  KeptPairs(const Surface& first, const Surface& second, int free_count, PairDistances distances);

  /// Finds what is to be kept, unless all places still are as foreseen. Throws std::invalid_argument where
  /// one is missing or not finite.
  void cover(PlaceList x0, PlaceList x1);

  /// Calls look(kind, particles, kept) for the pairs, but those that are further apart than `distance` in the
  /// direction in which they last were, before and after the step and so all the time.
  template <class Look>
  void for_each(PlaceList x0, PlaceList x1, double distance, const Look& look) {
    const float now = come_nearer(x0, x1);
    counts_.kept += static_cast<long>(vertex_face_.size() + edge_edge_.size());
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge})
      list_of(kind).for_each_from(now, [&](KeptPair& kept, float& clear_until) {
        const std::array<int, 4> p = particles_of(kind, kept.parts[0], kept.parts[1]);
        if (!is_apart(kind, p, kept, x0, x1, distance, clear_until)) look(kind, p, kept);
      });
  }

  const PairDistances& distances() const { return distances_; }
  const PairCounts& counts() const { return counts_; }

 private:
  PairList& list_of(PairKind kind) { return kind == PairKind::vertex_face ? vertex_face_ : edge_edge_; }
  std::array<int, 4> particles_of(PairKind kind, int i, int j) const;
  bool is_wanted(PairKind kind, const std::array<int, 4>& p) const;
  void place_particle(int i);
  void place_face(std::size_t f);
  void find_all(PlaceList x0, PlaceList x1);
  void find_of_strays();
  void find_near_strays();
  void keep_of_faces(int f, int g);
  void keep_if_near(PairKind kind, int i, int j);
  bool plane_parts(int f, int g) const;
  bool is_astray(std::span<const int> particles) const;
  float come_nearer(PlaceList x0, PlaceList x1);
  double nearer_since(PlaceList x) const;
  bool is_apart(PairKind kind, const std::array<int, 4>& p, const KeptPair& kept, PlaceList x0, PlaceList x1,
                double distance, float& clear_until);

  std::vector<std::array<int, 3>> faces_;
  std::vector<std::array<int, 2>> edges_;
  std::vector<int> vertices_;
  std::vector<OwnFeatures> own_;  // of each face
  int first_faces_, free_count_, particles_;
  PairDistances distances_;
  ForeseenWays ways_;
  std::vector<Eigen::Vector3d> middle_;              // of particles, halfway
  std::vector<Eigen::Vector3d> face_normal_;         // then; zero without one
  std::vector<std::array<double, 2>> along_normal_;  // of a face: least and most of its half ways along it
  std::vector<Box> of_particle_, of_vertex_, of_edge_, of_face_;
  std::vector<char> astray_;      // of particles, while those of strays alone are looked for
  std::vector<Box> of_stray_;     // around all its faces
  std::vector<int> near_strays_;  // faces
  bool of_strays_ = false;
  BoxPairs boxes_;
  PairList vertex_face_, edge_edge_;
  std::vector<Eigen::Vector3d> last_;  // where particles were when pairs were last gone through
  double nearer_ = 0;                  // by how much two may have come nearer until then, in all [m]
  PairCounts counts_;
};

}  // namespace springstab
