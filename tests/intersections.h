// Which triangles of a mesh cut each other, by brute force over all pairs and with nothing of
// solvers/contact: two triangles do where an edge of one, without a corner in common, meets the other, which
// the signs of five determinants tell (Plücker). Determinants within rounding of zero count as meeting. Two
// triangles in one plane are left out, as are those with an edge in common.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace springstab::test {

using Corners = std::array<int, 3>;

/// The sign of the determinant (b - a, c - a, d - a); 0 within its rounding.
inline int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d) {
  using Exact = long double;
  const Exact u[3] = {Exact(b[0]) - a[0], Exact(b[1]) - a[1], Exact(b[2]) - a[2]};
  const Exact v[3] = {Exact(c[0]) - a[0], Exact(c[1]) - a[1], Exact(c[2]) - a[2]};
  const Exact w[3] = {Exact(d[0]) - a[0], Exact(d[1]) - a[1], Exact(d[2]) - a[2]};
  Exact sum = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += u[i] * (v[j] * w[k] - v[k] * w[j]);
    size += std::abs(u[i]) * (std::abs(v[j] * w[k]) + std::abs(v[k] * w[j]));
  }
  if (std::abs(sum) <= 1e-18L * size) return 0;
  return sum > 0 ? 1 : -1;
}

/// Whether the segment pq meets the triangle abc, which does not lie in one plane with it.
inline bool segment_meets(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const int from = orientation(a, b, c, p), to = orientation(a, b, c, q);
  if (from * to > 0 || (from == 0 && to == 0)) return false;
  const int around[3] = {orientation(p, q, a, b), orientation(p, q, b, c), orientation(p, q, c, a)};
  return (around[0] >= 0 && around[1] >= 0 && around[2] >= 0) ||
         (around[0] <= 0 && around[1] <= 0 && around[2] <= 0);
}

/// Whether an edge of f without a corner in common with g meets g.
inline bool edge_meets(const Corners& f, const Corners& g, std::span<const Eigen::Vector3d> x) {
  const auto is_of_g = [&](int i) { return std::find(g.begin(), g.end(), i) != g.end(); };
  for (int e = 0; e < 3; ++e) {
    const int p = f[e], q = f[(e + 1) % 3];
    if (!is_of_g(p) && !is_of_g(q) && segment_meets(x[p], x[q], x[g[0]], x[g[1]], x[g[2]])) return true;
  }
  return false;
}

/// All pairs of triangles that cut each other.
inline std::vector<std::array<int, 2>> intersecting_triangles(std::span<const Corners> triangles,
                                                              std::span<const Eigen::Vector3d> x) {
  struct Box {
    Eigen::Array3d low, high;
  };
  std::vector<Box> boxes;
  for (const Corners& t : triangles)
    boxes.push_back({x[t[0]].array().min(x[t[1]].array()).min(x[t[2]].array()),
                     x[t[0]].array().max(x[t[1]].array()).max(x[t[2]].array())});
  std::vector<std::array<int, 2>> pairs;
  for (int i = 0; i < static_cast<int>(triangles.size()); ++i)
    for (int j = i + 1; j < static_cast<int>(triangles.size()); ++j)
      if ((boxes[i].low <= boxes[j].high).all() && (boxes[j].low <= boxes[i].high).all() &&
          (edge_meets(triangles[i], triangles[j], x) || edge_meets(triangles[j], triangles[i], x)))
        pairs.push_back({i, j});
  return pairs;
}

}  // namespace springstab::test
