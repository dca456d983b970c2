#include "solvers/contact/first_impact.h"

#include <algorithm>
#include <cmath>

namespace springstab {
namespace {

constexpr double rounding_of_f = 1e-14;    // relative to its terms
constexpr double rounding_of_gap = 1e-14;  // relative to the pair's extent: a plane with less proves nothing
constexpr double nearest_advance = 0.1;    // of the distance: so close the next plane is sought
constexpr int most_planes = 200;

/// The motion seen from the first particle.
struct PairMotion {
  PairKind kind;
  FourPlaces from, to;
  double extent = 0;  // at most the largest distance between two of them, and at least half of it

  PairMotion(PairKind of, const FourPlaces& x0, const FourPlaces& x1) : kind(of) {
    for (int i = 0; i < 4; ++i) {
      from[i] = x0[i] - x0[0];
      to[i] = x1[i] - x1[0];
      extent = std::max({extent, from[i].norm(), to[i].norm()});
    }
  }
  FourPlaces at(double t) const {
    FourPlaces x;
    for (int i = 0; i < 4; ++i) x[i] = (1 - t) * from[i] + t * to[i];
    return x;
  }
  /// How many of the four are of the first part.
  int first_count() const { return kind == PairKind::vertex_face ? 1 : 2; }
};

// Until when the plane across n, which separates the two at t, does so; infinite if to the end.
double separated_until(const PairMotion& pair, const Eigen::Vector3d& n, const FourPlaces& now, double t,
                       double end) {
  const FourPlaces then = pair.at(end);
  double nearest = HUGE_VAL;
  for (int i = 0; i < pair.first_count(); ++i)
    for (int j = pair.first_count(); j < 4; ++j) nearest = std::min(nearest, n.dot(now[i] - now[j]));
  const double rounding = rounding_of_gap * pair.extent;
  if (!(nearest > rounding)) return t;
  const double close = std::max(nearest_advance * nearest, rounding);
  double until = HUGE_VAL;
  for (int i = 0; i < pair.first_count(); ++i)
    for (int j = pair.first_count(); j < 4; ++j) {
      const double gap = n.dot(now[i] - now[j]), last = n.dot(then[i] - then[j]);
      if (last < close) until = std::min(until, t + (end - t) * ((gap - close) / (gap - last)));
    }
  return until;
}

struct Meeting {
  double time;
  FourPlaces x;
  ClosestPlaces places;
};

// The first time in [t, end] at which the two are closer than the tolerance; nothing where planes prove that
// there is none.
std::optional<Meeting> first_within(const PairMotion& pair, double t, double end, double tolerance,
                                    int planes) {
  for (int k = 0;; ++k) {
    const FourPlaces x = pair.at(t);
    const ClosestPlaces places = closest_places(pair.kind, x);
    if (k == planes || places.difference.norm() <= tolerance) return Meeting{t, x, places};
    double until = separated_until(pair, direction_between(pair.kind, x, places), x, t, end);
    if (until <= t) {  // as a face collapses its normal is told for longer than places within it
      const Eigen::Vector3d n = normal_of_touch(pair.kind, x);
      until = separated_until(pair, std::copysign(1, n.dot(places.difference)) * n, x, t, end);
    }
    if (until > end) return std::nullopt;
    if (until <= t) return Meeting{t, x, places};
    t = until;
  }
}

bool parts_at_once(const PairMotion& pair) {
  const ClosestPlaces places = closest_places(pair.kind, pair.from);
  return separated_until(pair, direction_between(pair.kind, pair.from, places), pair.from, 0, 1) > 1;
}

class Coplanarity {
 public:
  explicit Coplanarity(const PairMotion& pair)
      : from_(pair_directions(pair.kind, pair.from)), to_(pair_directions(pair.kind, pair.to)) {
    const double u = std::max(from_.u.norm(), to_.u.norm()), w = std::max(from_.w.norm(), to_.w.norm()),
                 d = std::max(from_.d.norm(), to_.d.norm());
    rounding_ = rounding_of_f * pair.extent * (u * w + w * d + d * u);
  }

  double operator()(double t) const {
    const auto at = [t](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (1 - t) * a + t * b; };
    return at(from_.u, to_.u).cross(at(from_.w, to_.w)).dot(at(from_.d, to_.d));
  }
  /// Its sign where that is beyond rounding, else 0.
  int sign(double value) const { return value > rounding_ ? 1 : value < -rounding_ ? -1 : 0; }

  /// 0, the roots of the derivative in between, 1; how many.
  int ends_of_monotone_parts(std::array<double, 4>& ends) const {
    const Eigen::Vector3d du = to_.u - from_.u, dw = to_.w - from_.w, dd = to_.d - from_.d;
    const Eigen::Vector3d n0 = from_.u.cross(from_.w), n2 = du.cross(dw),
                          n1 = du.cross(from_.w) + from_.u.cross(dw);
    const double c1 = n1.dot(from_.d) + n0.dot(dd), c2 = n2.dot(from_.d) + n1.dot(dd), c3 = n2.dot(dd);
    int count = 0;
    ends[count++] = 0;
    const double discriminant = c2 * c2 - 3 * c1 * c3;
    if (discriminant > 0) {
      const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
      double roots[2] = {q / (3 * c3), c1 / q};
      if (!(roots[0] <= roots[1])) std::swap(roots[0], roots[1]);
      for (const double root : roots)
        if (root > ends[count - 1] && root < 1) ends[count++] = root;
    }
    ends[count++] = 1;
    return count;
  }

  /// In a monotone part, from p, where f is beyond rounding, towards q, where it is not so with that sign:
  /// how far it is so for certain.
  double certain_until(double p, double q) const {
    const int certain = sign((*this)(p));
    for (double middle = (p + q) / 2; middle != p && middle != q; middle = (p + q) / 2)
      (sign((*this)(middle)) == certain ? p : q) = middle;
    return p;
  }

 private:
  PairDirections from_, to_;
  double rounding_;
};

// Where the side from which they come is not told by f, it is by their velocity, or by nothing.
Eigen::Vector3d normal_of(const PairMotion& pair, const Meeting& at, int side, double tolerance) {
  if (at.places.difference.norm() > 0.01 * tolerance) return direction_between(pair.kind, at.x, at.places);
  const PairDirections p = pair_directions(pair.kind, at.x);
  const Eigen::Vector3d n = p.u.cross(p.w);
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) way += at.places.weights[i] * (pair.to[i] - pair.from[i]);
  if (n.squaredNorm() > 1e-16 * p.u.squaredNorm() * p.w.squaredNorm())
    return std::copysign(1 / n.norm(), side != 0 ? side : -n.dot(way)) * n;
  for (const Eigen::Vector3d& along : {at.places.difference, Eigen::Vector3d(-way)})
    if (along.stableNorm() > 0) return along.stableNormalized();
  return Eigen::Vector3d::UnitY();
}

}  // namespace

std::optional<Impact> first_impact(PairKind kind, const FourPlaces& from, const FourPlaces& to) {
  const PairMotion pair(kind, from, to);
  if (parts_at_once(pair)) return std::nullopt;
  const double tolerance = collision_tolerance * pair.extent;
  const Coplanarity f(pair);
  std::array<double, 4> ends;
  const int count = f.ends_of_monotone_parts(ends);
  int side = 0;  // the last one for certain
  for (int k = 1; k < count; ++k) {
    double p = ends[k - 1], q = ends[k];
    const int first = f.sign(f(p)), last = f.sign(f(q));
    if (first != 0) side = first;
    if (first != 0 && first == last) continue;
    const double begin = first != 0 ? f.certain_until(p, q) : p, end = last != 0 ? f.certain_until(q, p) : q;
    const std::optional<Meeting> meeting = first_within(pair, begin, end, tolerance, most_planes);
    if (meeting) return Impact{meeting->time, meeting->places, normal_of(pair, *meeting, side, tolerance)};
  }
  return std::nullopt;
}

}  // namespace springstab
