// When a vertex and a face, or two edges, first meet while their particles move uniformly, over a step as the
// unit of time. They can meet only where the four are in one plane,
//     f(t) = det(u(t), w(t), d(t)) = 0   (closest_places.h),
// a cubic: between the roots of f' it is monotone, so that bisection finds where |f| is within its rounding,
// and outside of those, mostly tiny, parts of the step nothing meets. In each of them the time advances as
// far as a plane between the two proves that they are apart, until they are closer than the tolerance or the
// part is over. So nothing that meets is missed, also where f vanishes all the time or edges are parallel.
#pragma once

#include <optional>

#include "solvers/contact/closest_places.h"

namespace springstab {

/// What does not quite meet counts as meeting where it comes closer than this times the largest distance
/// between the pair's particles, before and after the step.
inline constexpr double collision_tolerance = 1e-8;

struct Impact {
  double time;             // in [0, 1]
  ClosestPlaces places;    // then
  Eigen::Vector3d normal;  // a unit vector, from the second of the two to the first as they were before
};

/// Those that touch at the start, to the tolerance, meet at 0 unless a plane proves that they part.
std::optional<Impact> first_impact(PairKind kind, const FourPlaces& from, const FourPlaces& to);

}  // namespace springstab
