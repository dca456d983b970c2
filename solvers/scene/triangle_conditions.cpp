#include "solvers/scene/triangle_conditions.h"

namespace springstab {
// With the edges (u1, v1), (u2, v2) from corner 0 and their determinant D = u1 v2 - u2 v1, twice the signed
// area: φ_1 = (u v2 - v u2)/D and φ_2 = (v u1 - u v1)/D.
TriangleConditions::TriangleConditions(const std::vector<RestTriangle>& triangles, AreaScaling scaling,
                                       int free_count)
    : elements_(triangles, free_count), shapes_(elements_.batches()) {
  for (int slot = 0; slot < batch_size * elements_.batches(); ++slot) {
    const int t = std::min(slot, elements_.size() - 1);
    const auto& uv = triangles[t].uv;
    const Eigen::Vector2d e1 = uv[1] - uv[0], e2 = uv[2] - uv[0];
    const double determinant = e1.x() * e2.y() - e2.x() * e1.y(), area = std::abs(determinant) / 2;
    if (!(area > 0))
      throw std::invalid_argument("triangle " + std::to_string(t) + " has an area of " +
                                  std::to_string(area) + " m² in (u, v), expected a positive one");
    Shapes& s = shapes_[slot / batch_size];
    const int lane = slot % batch_size;
    s.a1[lane] = e2.y() / determinant;
    s.a2[lane] = -e1.y() / determinant;
    s.b1[lane] = -e2.x() / determinant;
    s.b2[lane] = e1.x() / determinant;
    s.weight[lane] = scaling == AreaScaling::continuum ? area : area * area;
  }
}

}  // namespace springstab
