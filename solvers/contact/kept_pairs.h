// The pairs of vertices and faces, and of edges, that may come within reach of each other while ways are as
// foreseen (foreseen_ways.h): by a tree of boxes around the ways, or of the few that have left them by the
// boxes of all; those of faces that share a particle, whose boxes always meet, from a list. And of these
// pairs those that are not clear: each has a direction in which it was apart, and is as long as no two places
// have come that much nearer to each other.
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

/// A box at the start of the ways and one at their end, in between what is in between, beside where all go on
/// average.
struct MovingBox {
  Box start, end;

  /// Unless they are apart in one sense of one coordinate at both, and so all the time.
  bool meets(const MovingBox& other) const {
    const auto below = (other.start.low - start.high).min(other.end.low - end.high),
               above = (start.low - other.start.high).min(end.low - other.end.high);
    return below.max(above).maxCoeff() <= 0;
  }
  Box all() const { return {start.low.min(end.low), start.high.max(end.high)}; }
};

class KeptPairs {
 public:
  using PlaceList = std::span<const Eigen::Vector3d>;

  /// Of `first` with itself, where `second` is empty; see SurfacePairs.
  KeptPairs(const Surface& first, const Surface& second, int free_count, PairDistances distances);

  /// Finds what is to be kept, unless all places still are as foreseen. Throws std::invalid_argument where
  /// one is missing or not finite.
  void cover(PlaceList x0, PlaceList x1);

  /// Calls look(kind, particles, kept, may_meet) for the pairs, but those that are further apart than
  /// `distance` in the direction in which they last were, before and after the step and so all the time; they
  /// may meet in it unless they are apart at all.
  template <class Look>
  void for_each(PlaceList x0, PlaceList x1, double distance, const Look& look) {
    const float now = come_nearer(x0, x1);
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge}) {
      PairList& list = found_[number_of(kind)];
      counts_.kept += static_cast<long>(list.size());
      list.for_each_from(now, [&](KeptPair& kept) {
        const std::array<int, 4> p = particles_of(kind, kept.parts[0], kept.parts[1]);
        const double gap = gap_in_step(kind, p, kept, x0, x1);
        if (!is_apart(gap, distance)) look(kind, p, kept, !is_apart(gap, 0));
      });
    }
  }

  const PairDistances& distances() const { return distances_; }
  const PairCounts& counts() const { return counts_; }

 private:
  static std::size_t number_of(PairKind kind) { return kind == PairKind::vertex_face ? 0 : 1; }
  std::array<int, 4> particles_of(PairKind kind, int i, int j) const;
  bool is_wanted(PairKind kind, const std::array<int, 4>& p) const;
  void place_particle(int i);
  void place_face(std::size_t f);
  void find_all(PlaceList x0, PlaceList x1);
  void find_of_strays();
  void find_near_strays();
  bool are_adjacent(int f, int g) const;
  void list_adjacent();
  void keep_adjacent();
  template <class Visit>
  void for_each_own_pair(int f, int g, const Visit& visit) const;
  void keep_of_faces(int f, int g);
  Eigen::Vector3d keep_if_near(PairKind kind, int i, int j, const std::array<int, 4>& p);
  bool plane_parts(int f, int g) const;
  bool is_astray(std::span<const int> particles) const;
  float come_nearer(PlaceList x0, PlaceList x1);
  double nearer_on_way(PlaceList x0, PlaceList x1) const;
  double gap_in_step(PairKind kind, const std::array<int, 4>& p, KeptPair& kept, PlaceList x0, PlaceList x1);
  bool is_apart(double gap, double distance) const;

  std::vector<std::array<int, 3>> faces_;
  std::vector<std::array<int, 2>> edges_;
  std::vector<int> vertices_;
  std::vector<std::array<int, 3>> joints_;  // of faces: their particles, if not of more than a few faces
  std::vector<OwnFeatures> own_;            // of each face
  int first_faces_, free_count_, particles_;
  PairDistances distances_;
  ForeseenWays ways_;
  std::vector<Eigen::Vector3d> middle_;              // of particles, halfway
  std::vector<Eigen::Vector3d> face_normal_;         // then; zero without one
  std::vector<std::array<double, 2>> along_normal_;  // of a face: least and most of its half ways along it
  std::vector<MovingBox> of_particle_, of_edge_, of_face_;
  std::vector<Box> around_faces_;
  std::vector<char> astray_;         // of particles, while those of strays alone are looked for
  std::vector<MovingBox> of_stray_;  // around all its faces
  std::vector<int> near_strays_;     // faces
  bool of_strays_ = false;
  BoxPairs boxes_;
  std::array<PairList, 2> found_;                     // of each kind
  std::array<std::vector<KeptPair>, 2> adjacent_;     // likewise, of faces that share a particle
  std::vector<Eigen::Vector3d> ways_from_, ways_to_;  // of particles
  std::vector<Eigen::Vector3d> last_;                 // where they were when pairs were last gone through
  double nearer_ = 0;  // by how much two may have come nearer until then, since pairs were found [m]
  PairCounts counts_;
};

}  // namespace springstab
