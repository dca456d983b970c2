#include "solvers/contact/half_spaces.h"

#include <Eigen/Dense>
#include <algorithm>

namespace springstab {
namespace {

bool holds_all(std::span<const HalfSpace> spaces, double rounding, const Eigen::Vector3d& w) {
  return std::all_of(spaces.begin(), spaces.end(),
                     [&](const HalfSpace& s) { return s.normal.dot(w) >= s.bound - rounding; });
}

// Whether with these, and no others, on their bounds the conditions of the solution hold.
template <int count>
bool try_binding(std::span<HalfSpace> spaces, const int (&binding)[count], double rounding,
                 Eigen::Vector3d& w) {
  Eigen::Matrix<double, 3, count> normals;
  Eigen::Vector<double, count> missing;
  for (int i = 0; i < count; ++i) {
    normals.col(i) = spaces[binding[i]].normal;
    missing[i] = spaces[binding[i]].bound - spaces[binding[i]].normal.dot(w);
  }
  // r = (NᵀN)⁻¹ missing by N = QR, which squares no condition.
  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 3, count>> qr(normals);
  if (qr.rank() < count) return false;
  const Eigen::Vector<double, count> permuted = qr.colsPermutation().transpose() * missing;
  const auto r_factor =
      qr.matrixR().template topLeftCorner<count, count>().template triangularView<Eigen::Upper>();
  const Eigen::Vector<double, count> solved =
      qr.colsPermutation() * r_factor.solve(r_factor.transpose().solve(permuted)).eval();
  if (!(solved.minCoeff() >= 0)) return false;
  const Eigen::Vector3d moved = w + normals * solved;
  if (!holds_all(spaces, rounding, moved)) return false;
  for (HalfSpace& space : spaces) space.multiplier = 0;
  for (int i = 0; i < count; ++i) spaces[binding[i]].multiplier = solved[i];
  w = moved;
  return true;
}

}  // namespace

bool project(std::span<HalfSpace> spaces, double rounding, Eigen::Vector3d& w) {
  for (HalfSpace& space : spaces) space.multiplier = 0;
  if (holds_all(spaces, 0, w)) return true;
  const int n = static_cast<int>(spaces.size());
  for (int i = 0; i < n; ++i)
    if (try_binding(spaces, {i}, rounding, w)) return true;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      if (try_binding(spaces, {i, j}, rounding, w)) return true;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k)
        if (try_binding(spaces, {i, j, k}, rounding, w)) return true;
  return false;
}

}  // namespace springstab
