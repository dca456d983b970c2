// The closest two places of a vertex and a face, or of two edges, at an instant. Where they are inside both,
// the difference of the two is along the normal of the plane that contains both directions, N = u × w:
//     vertex and face:  u = p1 - p0, w = p2 - p0, d = v - p0,    b1 = N·(d × w)/N², b2 = N·(u × d)/N²
//     edge and edge:    u = a1 - a0, w = b1 - b0, d = a0 - b0,   a = N·(w × d)/N²,  b = N·(u × d)/N²
// and else one of them is on a border, and the closest of vertex and edge are the answer.
#pragma once

#include <Eigen/Geometry>
#include <array>

namespace springstab {

/// What the four particles of a pair are: v, p0, p1, p2 or a0, a1, b0, b1.
enum class PairKind { vertex_face, edge_edge };
using FourPlaces = std::array<Eigen::Vector3d, 4>;

struct ClosestPlaces {
  std::array<double, 4> weights;  // w: 1, -b0, -b1, -b2 or a0, a1, -b0, -b1
  Eigen::Vector3d difference;     // Σ w x [m]
};

/// To rounding of the largest distance between the four; of degenerate faces and parallel edges, too.
ClosestPlaces closest_places(PairKind kind, const FourPlaces& x);

/// u, w and d of above.
struct PairDirections {
  Eigen::Vector3d u, w, d;
};
inline PairDirections pair_directions(PairKind kind, const FourPlaces& x) {
  if (kind == PairKind::vertex_face) return {x[2] - x[1], x[3] - x[1], x[0] - x[1]};
  return {x[1] - x[0], x[3] - x[2], x[0] - x[2]};
}

/// A unit vector along the difference; N where both places are inside, which is exact however close they are,
/// and across the edge where one is a vertex and the other within an edge. Zero where neither says anything.
Eigen::Vector3d direction_between(PairKind kind, const FourPlaces& x, const ClosestPlaces& closest);
/// A unit vector along N, on either side, or any where there is none: for places without a difference.
Eigen::Vector3d normal_of_touch(PairKind kind, const FourPlaces& x);

}  // namespace springstab
