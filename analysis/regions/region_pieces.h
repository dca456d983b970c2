// How StabilityRegion cuts the plane: columns of one X, and pieces between which the columns change smoothly.
// Shared by stability_region.cpp, region_boundary.cpp and region_constants.cpp; not for others.
#pragma once

#include <algorithm>

#include "analysis/regions/stability_region.h"

namespace springstab {

/// The stable intervals of Y at one X.
struct StabilityRegion::Column {
  double x;
  std::vector<StableInterval> intervals;

  bool same_structure(const Column& other) const {
    return std::equal(intervals.begin(), intervals.end(), other.intervals.begin(), other.intervals.end(),
                      [](const StableInterval& a, const StableInterval& b) {
                        return a.lower_bound == b.lower_bound && a.upper_bound == b.upper_bound;
                      });
  }
};

/// X in (left, right) over which the intervals keep their number and the conditions that end them.
struct StabilityRegion::Piece {
  double left, right;
  Column inner;  // a representative
};

/// X over the whole line, ascending, dense near 0, with 0 itself.
std::vector<double> whole_line();

/// A point strictly between a and b, either of which may be infinite.
double between(double a, double b);

/// A point of [left, right] for an angle in [0, π]: what ends like a square root is smooth in the angle.
double cosine_point(double left, double right, double angle);

}  // namespace springstab
