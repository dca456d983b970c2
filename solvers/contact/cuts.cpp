#include "solvers/contact/cuts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <vector>

namespace springstab {
namespace {

constexpr double rounding_of_cuts = 1e-12;  // relative, of places given in decimals

double volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

// How deep an edge of f is in g, if one passes through it.
std::optional<double> depth_of_edges(const std::array<int, 3>& f, const std::array<int, 3>& g,
                                     std::span<const Eigen::Vector3d> x) {
  const Eigen::Vector3d &a = x[g[0]], &b = x[g[1]], &c = x[g[2]];
  const double twice_area = (b - a).cross(c - a).norm();
  const double least = rounding_of_cuts * a.norm();
  double depth = least;
  for (int e = 0; e < 3; ++e) {
    const int i = f[e], j = f[(e + 1) % 3];
    if (std::any_of(g.begin(), g.end(), [&](int corner) { return corner == i || corner == j; })) continue;
    const Eigen::Vector3d &p = x[i], &q = x[j];
    const double from = volume(a, b, c, p), to = volume(a, b, c, q);
    if (!(from * to < 0)) continue;
    const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
    if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))
      depth = std::max(depth, std::min(std::abs(from), std::abs(to)) / twice_area);
  }
  return depth > least ? std::optional(depth) : std::nullopt;
}

Eigen::AlignedBox3d box_of(const std::array<int, 3>& f, std::span<const Eigen::Vector3d> x) {
  Eigen::AlignedBox3d box(x[f[0]]);
  return box.extend(x[f[1]]).extend(x[f[2]]);
}

}  // namespace

std::optional<Cut> first_cut(std::span<const std::array<int, 3>> first,
                             std::span<const std::array<int, 3>> second, std::span<const Eigen::Vector3d> x) {
  // Of the others only those are asked that begin along x where it may be.
  std::vector<std::pair<double, int>> begins;
  std::vector<Eigen::AlignedBox3d> boxes;
  double widest = 0;
  for (int g = 0; g < static_cast<int>(second.size()); ++g) {
    boxes.push_back(box_of(second[g], x));
    begins.emplace_back(boxes[g].min().x(), g);
    widest = std::max(widest, boxes[g].sizes().x());
  }
  std::sort(begins.begin(), begins.end());
  for (int f = 0; f < static_cast<int>(first.size()); ++f) {
    const Eigen::AlignedBox3d box = box_of(first[f], x);
    std::optional<Cut> cut;
    auto at = std::lower_bound(begins.begin(), begins.end(), std::pair(box.min().x() - widest, 0));
    for (; at != begins.end() && at->first <= box.max().x(); ++at) {
      const int g = at->second;
      if ((cut && g > cut->second) || !boxes[g].intersects(box)) continue;
      std::optional<double> depth = depth_of_edges(first[f], second[g], x);
      if (!depth) depth = depth_of_edges(second[g], first[f], x);
      if (depth) cut = Cut{f, g, *depth};
    }
    if (cut) return cut;
  }
  return std::nullopt;
}

}  // namespace springstab
