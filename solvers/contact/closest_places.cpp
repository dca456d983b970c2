#include "solvers/contact/closest_places.h"

#include <algorithm>
#include <cmath>

namespace springstab {
namespace {

// sin² of the angle between u and w from which on what is inside is exact enough to compare it with nothing.
constexpr double well_conditioned = 1e-12;

// The place of the segment a + s (b - a), 0 <= s <= 1, that is closest to c.
double closest_on_segment(const Eigen::Vector3d& c, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double square = along.squaredNorm();
  return square > 0 ? std::clamp(along.dot(c - a) / square, 0., 1.) : 0;
}

// Keeps the closer one of two answers.
struct Closer {
  ClosestPlaces best;
  double square = HUGE_VAL;

  void take(const std::array<double, 4>& weights, const Eigen::Vector3d& difference) {
    const double other = difference.squaredNorm();
    if (other >= square) return;
    square = other;
    best = {weights, difference};
  }
  // Vertex i and the edge jk, with the sign that the vertex has in the difference.
  void take_vertex_and_edge(const FourPlaces& x, int i, int j, int k, double sign) {
    const double s = closest_on_segment(x[i], x[j], x[k]);
    std::array<double, 4> weights{};
    weights[i] = sign;
    weights[j] = -sign * (1 - s);
    weights[k] = -sign * s;
    take(weights, sign * ((x[i] - x[j]) - s * (x[k] - x[j])));
  }
};

bool is_well_conditioned(const PairDirections& p, double normal_square) {
  return normal_square > well_conditioned * p.u.squaredNorm() * p.w.squaredNorm();
}

ClosestPlaces closest_of_vertex_and_face(const FourPlaces& x) {
  const PairDirections p = pair_directions(PairKind::vertex_face, x);
  const Eigen::Vector3d n = p.u.cross(p.w);
  const double square = n.squaredNorm();
  Closer closer;
  if (square > 0) {
    const double b1 = n.dot(p.d.cross(p.w)) / square, b2 = n.dot(p.u.cross(p.d)) / square, b0 = 1 - b1 - b2;
    if (b0 >= 0 && b1 >= 0 && b2 >= 0) {
      closer.take({1, -b0, -b1, -b2}, p.d - b1 * p.u - b2 * p.w);
      if (is_well_conditioned(p, square)) return closer.best;
    }
  }
  closer.take_vertex_and_edge(x, 0, 1, 2, 1);
  closer.take_vertex_and_edge(x, 0, 2, 3, 1);
  closer.take_vertex_and_edge(x, 0, 3, 1, 1);
  return closer.best;
}

ClosestPlaces closest_of_edges(const FourPlaces& x) {
  const PairDirections p = pair_directions(PairKind::edge_edge, x);
  const Eigen::Vector3d n = p.u.cross(p.w);
  const double square = n.squaredNorm();
  Closer closer;
  if (square > 0) {
    const double a = n.dot(p.w.cross(p.d)) / square, b = n.dot(p.u.cross(p.d)) / square;
    if (a >= 0 && a <= 1 && b >= 0 && b <= 1) {
      closer.take({1 - a, a, -(1 - b), -b}, p.d + a * p.u - b * p.w);
      if (is_well_conditioned(p, square)) return closer.best;
    }
  }
  closer.take_vertex_and_edge(x, 0, 2, 3, 1);
  closer.take_vertex_and_edge(x, 1, 2, 3, 1);
  closer.take_vertex_and_edge(x, 2, 0, 1, -1);
  closer.take_vertex_and_edge(x, 3, 0, 1, -1);
  return closer.best;
}

// The difference of a vertex and a place within an edge has none along the edge. What rounding gives it there
// is much, at the ends of the edge, where the two are close.
Eigen::Vector3d across_edge(const FourPlaces& x, const ClosestPlaces& closest) {
  std::array<int, 2> ends{};
  int within = 0;
  for (int i = 0; i < 4; ++i)
    if (const double w = std::abs(closest.weights[i]); w > 0 && w < 1) {
      if (within == 2) return closest.difference;
      ends[within++] = i;
    }
  if (within < 2) return closest.difference;
  const Eigen::Vector3d along = (x[ends[1]] - x[ends[0]]).normalized();
  return closest.difference - along.dot(closest.difference) * along;
}

}  // namespace

ClosestPlaces closest_places(PairKind kind, const FourPlaces& x) {
  return kind == PairKind::vertex_face ? closest_of_vertex_and_face(x) : closest_of_edges(x);
}

Eigen::Vector3d direction_between(PairKind kind, const FourPlaces& x, const ClosestPlaces& closest) {
  const PairDirections p = pair_directions(kind, x);
  const Eigen::Vector3d n = p.u.cross(p.w);
  const auto& w = closest.weights;
  const bool inside = w[1] != 0 && w[2] != 0 && w[3] != 0 && (kind == PairKind::vertex_face || w[0] != 0);
  if (inside && is_well_conditioned(p, n.squaredNorm()) && n.dot(p.d) != 0)
    return std::copysign(1 / n.norm(), n.dot(p.d)) * n;
  return across_edge(x, closest).stableNormalized();
}

Eigen::Vector3d normal_of_touch(PairKind kind, const FourPlaces& x) {
  const PairDirections p = pair_directions(kind, x);
  const Eigen::Vector3d n = p.u.cross(p.w);
  return n.squaredNorm() > 0 ? n.normalized() : Eigen::Vector3d::UnitY();
}

}  // namespace springstab
