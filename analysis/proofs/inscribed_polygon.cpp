#include "analysis/proofs/inscribed_polygon.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "analysis/per_method.h"

namespace springstab {
namespace {

constexpr double edge_inset = 1e-9;      // of an edge's distance from the origin
constexpr double tangent_inset = 1e-5;   // of a tangent at a sample of the boundary
constexpr double point_distance = 1e-6;  // points nearer than this are one

}  // namespace

double exit_step(const HalfPlane& half_plane, const ModePoint& p) {
  const double linear = half_plane.x * std::max(p.d, 0.0), quadratic = half_plane.y * std::max(p.k, 0.0);
  const double c = half_plane.bound;
  if (c == 0) return linear > 0 ? 0 : quadratic > 0 ? -linear / quadratic : infinity;
  const double discriminant = linear * linear + 4 * quadratic * c;
  const double sum = discriminant < 0 ? 0 : linear + std::sqrt(discriminant);
  return sum > 0 ? 2 * c / sum : infinity;
}

InscribedPolygons::InscribedPolygons(const StabilityRegion& region) {
  const Chain chain = boundary_chain(region);
  if (chain.size() < 2) return;
  const std::vector<std::size_t> cuts = reflex(chain);
  std::vector<Chain> parts;
  if (cuts.empty()) parts.push_back(chain);
  const std::size_t stride = std::max<std::size_t>(1, cuts.size() / 24);
  for (std::size_t i = 0; i < cuts.size(); i += stride) {
    Chain part = cut(chain, cuts[i]);
    for (int again = 0; again < 16; ++again) {  // other valleys, one by one
      const std::vector<std::size_t> rest = reflex(part);
      if (rest.empty()) break;
      part = cut(part, rest[rest.size() / 2]);
    }
    if (reflex(part).empty()) parts.push_back(std::move(part));
  }
  const auto has_edge = [](const Chain& part) { return part.size() > (part[1].x == 0 ? 2u : 1u); };
  for (Chain& part : parts)
    if (part.size() >= 2 && has_edge(part) && is_inside(region, part))
      convex_parts_.push_back(std::move(part));
}

// The boundary of the part of the region that touches the origin, in the quadrant: along its top to the
// right, then along its lower side back to the X axis.
InscribedPolygons::Chain InscribedPolygons::boundary_chain(const StabilityRegion& region) {
  const Window box = region.natural_window(0);
  std::vector<RegionPiece> pieces = region.pieces({0, box.x_max, 0, box.y_max});
  Chain top, bottom;
  const auto add = [](Chain& chain, double x, double y) {
    if (chain.empty() || std::hypot(x - chain.back().x, y - chain.back().y) > point_distance)
      chain.push_back({x, y});
  };
  double x = 0, lower = 0, upper = 0;
  for (const RegionPiece& piece : pieces) {
    const bool follows = piece.x.front() <= x + point_distance && piece.x.back() > x &&
                         piece.y_lower.front() <= upper + point_distance &&
                         piece.y_upper.front() >= lower - point_distance;
    if (!follows) continue;
    for (std::size_t i = 0; i < piece.x.size(); ++i) {
      add(top, piece.x[i], piece.y_upper[i]);
      add(bottom, piece.x[i], piece.y_lower[i]);
    }
    x = piece.x.back(), lower = piece.y_lower.back(), upper = piece.y_upper.back();
  }
  if (top.empty() || top.front().x > point_distance || bottom.front().y > point_distance) return {};
  top.front() = {0, top.front().y < 1e-4 ? 0 : top.front().y};
  if (top.front().y > 0) top.insert(top.begin(), {0, 0});
  for (auto p = bottom.rbegin(); p != bottom.rend(); ++p) {
    if (p->y <= point_distance) p->y = 0;
    add(top, p->x, p->y);
    if (p->y == 0) break;
  }
  return top;
}

// Where the chain turns left.
std::vector<std::size_t> InscribedPolygons::reflex(const Chain& chain) {
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
    const double ux = chain[i].x - chain[i - 1].x, uy = chain[i].y - chain[i - 1].y;
    const double vx = chain[i + 1].x - chain[i].x, vy = chain[i + 1].y - chain[i].y;
    if (ux * vy - uy * vx > 1e-7 * std::hypot(ux, uy) * std::hypot(vx, vy)) found.push_back(i);
  }
  return found;
}

// What is on the origin's side of the tangent at a sample.
InscribedPolygons::Chain InscribedPolygons::cut(const Chain& chain, std::size_t at) {
  HalfPlane line = edge(chain[at - 1], chain[at + 1]);
  line.bound = (line.x * chain[at].x + line.y * chain[at].y) * (1 - tangent_inset);
  const auto outside = [&](const Vertex& p) { return line.x * p.x + line.y * p.y - line.bound; };
  Chain part;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (i > 0 && (outside(chain[i - 1]) > 0) != (outside(chain[i]) > 0)) {
      const double a = outside(chain[i - 1]), b = outside(chain[i]), t = a / (a - b);
      part.push_back({chain[i - 1].x + t * (chain[i].x - chain[i - 1].x),
                      chain[i - 1].y + t * (chain[i].y - chain[i - 1].y)});
    }
    if (outside(chain[i]) <= 0) part.push_back(chain[i]);
  }
  Chain apart;  // crossings may coincide with samples
  for (const Vertex& p : part)
    if (apart.empty() || std::hypot(p.x - apart.back().x, p.y - apart.back().y) > point_distance)
      apart.push_back(p);
  return apart;
}

// Every edge, and the fan of segments from the origin to the vertices, checked by Jury's polynomials on them.
bool InscribedPolygons::is_inside(const StabilityRegion& region, const Chain& chain) {
  const double shrink = 1 - edge_inset;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const double x = shrink * chain[i].x, y = shrink * chain[i].y;
    if (!region.closed_segment_is_stable(0, 0, x, y)) return false;
    if (i > 0 && !region.closed_segment_is_stable(shrink * chain[i - 1].x, shrink * chain[i - 1].y, x, y))
      return false;
  }
  return true;
}

HalfPlane InscribedPolygons::edge(const Vertex& p, const Vertex& q) {
  const HalfPlane side{p.y - q.y, q.x - p.x, 0};
  const bool from_origin = p.x == 0 && p.y == 0;
  return {side.x, side.y, from_origin ? 0 : (side.x * p.x + side.y * p.y) * (1 - edge_inset)};
}

// Vertices of the chain are added where the modes touch an edge, and those that are not needed removed: a
// polygon over fewer points of a convex chain lies inside it.
PolygonFit InscribedPolygons::fit(const Chain& chain, const std::vector<ModePoint>& modes) {
  std::vector<std::size_t> corners;
  constexpr std::size_t first_edges = 8, most_edges = 48;
  const std::size_t first = chain[1].x == 0 ? 1 : 0;  // the Y axis needs no edge
  for (std::size_t i = 0; i <= first_edges; ++i) {
    const std::size_t corner = first + i * (chain.size() - 1 - first) / first_edges;
    if (corners.empty() || corner > corners.back()) corners.push_back(corner);
  }
  const auto limit = [&](const std::vector<std::size_t>& at) {
    std::pair<double, std::size_t> least{infinity, 0};
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const HalfPlane side = edge(chain[at[i]], chain[at[i + 1]]);
      for (const ModePoint& mode : modes) least = std::min(least, {exit_step(side, mode), i});
    }
    return least;
  };
  while (corners.size() <= most_edges) {
    const std::size_t i = limit(corners).second;
    if (corners[i + 1] == corners[i] + 1) break;
    corners.insert(corners.begin() + static_cast<long>(i) + 1, (corners[i] + corners[i + 1]) / 2);
  }
  const double best = limit(corners).first;
  for (std::size_t i = corners.size() - 2; i > 0 && corners.size() + first > 3; --i) {  // with the origin
    std::vector<std::size_t> fewer;
    for (std::size_t j = 0; j < corners.size(); ++j)
      if (j != i) fewer.push_back(corners[j]);
    if (limit(fewer).first >= best * (1 - 1e-4)) corners = fewer;
  }
  PolygonFit found{limit(corners).first, {}};
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
    found.edges.push_back(edge(chain[corners[i]], chain[corners[i + 1]]));
  return found;
}

PolygonFit InscribedPolygons::fit(const std::vector<ModePoint>& modes) const {
  PolygonFit best;
  for (const Chain& part : convex_parts_)
    if (PolygonFit found = fit(part, modes); found.h > best.h || best.edges.empty()) best = std::move(found);
  return best;
}

const InscribedPolygons& inscribed_polygons(const Method& method) {
  static PerMethod<InscribedPolygons> all;
  return all.of(method, [&] { return InscribedPolygons(stability_region(method)); });
}

}  // namespace springstab
