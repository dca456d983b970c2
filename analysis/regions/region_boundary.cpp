// The region inside a window, from its smooth pieces: area, boundary arcs, filled pieces.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "analysis/gsl/numerics.h"
#include "analysis/regions/region_pieces.h"
#include "analysis/regions/sampled_curve.h"
#include "analysis/regions/stability_region.h"

namespace springstab {
namespace {

constexpr int arc_samples = 128;  // points of an arc

using Intervals = std::vector<StableInterval>;

// Parts of `a` that are not in `b`; the ends keep no condition.
std::vector<std::pair<double, double>> difference(const Intervals& a, const Intervals& b) {
  std::vector<std::pair<double, double>> parts;
  for (const StableInterval& interval : a) {
    double lower = interval.lower;
    for (const StableInterval& other : b) {
      if (other.upper <= lower || other.lower >= interval.upper) continue;
      if (other.lower > lower) parts.emplace_back(lower, other.lower);
      lower = other.upper;
    }
    if (lower < interval.upper) parts.emplace_back(lower, interval.upper);
  }
  return parts;
}

}  // namespace

std::vector<StabilityRegion::Piece> StabilityRegion::pieces_of(const Window& window) const {
  if (!(window.x_min < window.x_max) || !(window.y_min < window.y_max))
    throw std::invalid_argument("the window must have x_min < x_max and y_min < y_max");
  constexpr int cells = 400;
  std::vector<double> grid;
  for (int i = 0; i <= cells; ++i) grid.push_back(window.x_min + (window.x_max - window.x_min) * i / cells);

  // What is narrower than a cell: between the X where the whole region's columns change, or where the
  // boundary crosses the lower or the upper edge.
  std::vector<double> changes{window.x_min, window.x_max};
  const auto add = [&](double x) {
    if (x > window.x_min && x < window.x_max) changes.push_back(x);
  };
  for (const Piece& piece : all_pieces_) add(piece.left), add(piece.right);
  for (const double y : {window.y_min, window.y_max})
    for (const StableInterval& interval : stable_intervals({{{0, 1}}, {{y}}}, window.x_min, window.x_max))
      add(interval.lower), add(interval.upper);
  std::sort(changes.begin(), changes.end());
  for (std::size_t i = 0; i + 1 < changes.size(); ++i)
    if (changes[i + 1] - changes[i] > 1e-12 * std::max(1.0, std::abs(changes[i])))
      grid.push_back(between(changes[i], changes[i + 1]));
  std::sort(grid.begin(), grid.end());
  return smooth_pieces(grid, window.y_min, window.y_max);
}

double StabilityRegion::area(const Window& window) const {
  // A needle, as where two real eigenvalues lie in an interval of their own, has sides known to fewer digits.
  const double size = (window.x_max - window.x_min) * (window.y_max - window.y_min);
  double area = 0;
  for (const Piece& piece : pieces_of(window)) {
    const auto strip = [&](double angle) {
      double height = 0;
      const Column c = column(cosine_point(piece.left, piece.right, angle), window.y_min, window.y_max);
      for (const StableInterval& interval : c.intervals) height += interval.upper - interval.lower;
      return height * 0.5 * (piece.right - piece.left) * std::sin(angle);
    };
    const Integral part = integral(strip, 0, std::numbers::pi);
    if (!part.failure.empty() && part.error > 1e-10 * std::max(1.0, size))
      throw std::runtime_error("the area of the region: " + part.failure);
    area += part.value;
  }
  return area;
}

std::vector<RegionPiece> StabilityRegion::pieces(const Window& window) const {
  std::vector<RegionPiece> result;
  for (const Piece& piece : pieces_of(window)) {
    const std::size_t count = piece.inner.intervals.size();
    std::vector<RegionPiece> parts(count);
    for (const Column& c : sample(piece, window)) {
      for (std::size_t i = 0; i < count; ++i) {
        parts[i].x.push_back(c.x);
        parts[i].y_lower.push_back(c.intervals[i].lower);
        parts[i].y_upper.push_back(c.intervals[i].upper);
      }
    }
    result.insert(result.end(), parts.begin(), parts.end());
  }
  return result;
}

// Columns of a piece, its ends included (but for a hair's breadth, since the ends belong to no piece).
std::vector<StabilityRegion::Column> StabilityRegion::sample(const Piece& piece, const Window& window) const {
  std::vector<Column> columns;
  const double inset = 1e-11 * std::max(piece.right - piece.left, 1e-3);
  for (int i = 0; i <= arc_samples; ++i) {
    const double x = std::clamp(cosine_point(piece.left, piece.right, std::numbers::pi * i / arc_samples),
                                piece.left + inset, piece.right - inset);
    Column c = column(x, window.y_min, window.y_max);
    if (c.intervals.size() == piece.inner.intervals.size()) columns.push_back(std::move(c));
  }
  return columns;
}

std::vector<BoundaryArc> StabilityRegion::boundary(const Window& window) const {
  std::vector<BoundaryArc> arcs;
  const std::vector<Piece> all = pieces_of(window);
  for (const Piece& piece : all) {
    const std::vector<Column> columns = sample(piece, window);
    for (std::size_t i = 0; i < piece.inner.intervals.size(); ++i) {
      const StableInterval& interval = piece.inner.intervals[i];
      for (const bool upper : {false, true}) {
        BoundaryArc arc{upper ? interval.upper_bound : interval.lower_bound, {}, {}};
        if (arc.bound == Bound::window) continue;
        for (const Column& c : columns) {
          arc.x.push_back(c.x);
          arc.y.push_back(upper ? c.intervals[i].upper : c.intervals[i].lower);
        }
        arcs.push_back(std::move(arc));
      }
    }
  }
  append_vertical_arcs(all, window, arcs);
  return arcs;
}

Bound StabilityRegion::binding_at(double x, double y) const {
  if (by_values_) return binding_condition(method_, x, y);
  const auto violation = [&](std::size_t i) { return std::abs(jury_[i](x, y)); };
  std::size_t binding = 0;
  for (std::size_t i = 1; i < jury_.size(); ++i)
    if (violation(i) < violation(binding)) binding = i;
  return static_cast<Bound>(binding);
}

// Where the intervals jump at an X, the boundary runs along that X.
void StabilityRegion::append_vertical_arcs(const std::vector<Piece>& all, const Window& window,
                                           std::vector<BoundaryArc>& arcs) const {
  // Slivers of 1e-12 belong to no piece (see smooth_pieces), so neighbours may end a hair's breadth apart.
  const auto same = [](double a, double b) { return std::abs(a - b) <= 4e-12 * std::max(1.0, std::abs(a)); };
  std::vector<double> ends;
  for (const Piece& piece : all)
    for (const double x : {piece.left, piece.right})
      if (std::none_of(ends.begin(), ends.end(), [&](double end) { return same(end, x); })) ends.push_back(x);
  for (const double x : ends) {
    if (same(x, window.x_min) || same(x, window.x_max)) continue;
    Intervals left, right;
    for (const Piece& piece : all) {
      const std::vector<Column> columns = sample(piece, window);
      if (columns.empty()) continue;
      if (left.empty() && same(piece.right, x)) left = columns.back().intervals;
      if (same(piece.left, x)) right = columns.front().intervals;
    }
    for (const auto& parts : {difference(left, right), difference(right, left)})
      for (const auto& [lower, upper] : parts) {
        if (upper - lower < 1e-3) continue;  // the inset of a square- or cube-root end
        arcs.push_back({binding_at(x, between(lower, upper)), {x, x}, {lower, upper}});
      }
  }
}

Window StabilityRegion::natural_window(double margin) const {
  Window box{INFINITY, -INFINITY, INFINITY, -INFINITY};
  for (const Piece& piece : all_pieces_) {
    box.x_min = std::min(box.x_min, piece.left);
    box.x_max = std::max(box.x_max, piece.right);
    for (const Column& c : sample(piece, {0, 0, -INFINITY, INFINITY})) {
      box.y_min = std::min(box.y_min, c.intervals.front().lower);
      box.y_max = std::max(box.y_max, c.intervals.back().upper);
    }
  }
  box.y_max = std::max(box.y_max, constants_.y_max);  // the apex lies between two samples
  const bool ends = by_values_ && std::isfinite(constants_.real_interval);
  if (!std::isfinite(box.y_max - box.y_min) ||
      (!ends && std::max(-box.x_min, box.x_max) > 0.9 * whole_line().back()))
    return {-8, 8, -8, 8};
  const double dx = margin * (box.x_max - box.x_min), dy = margin * (box.y_max - box.y_min);
  return {box.x_min - dx, box.x_max + dx, box.y_min - dy, box.y_max + dy};
}

}  // namespace springstab
