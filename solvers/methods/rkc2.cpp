#include "solvers/methods/rkc2.h"

namespace springstab {

// a_j = 1 - b_j T_j(w₀), b_j = T''_j(w₀)/T'_j(w₀)², b₀ = b₁ = b₂, w₁ = T'_s(w₀)/T''_s(w₀).
std::vector<Rkc2::Stage> Rkc2::coefficients() const {
  const auto s = static_cast<std::size_t>(stages);
  const double w0 = 1 + 2. / 13 / static_cast<double>(s * s);
  std::vector<double> t{1, w0}, slope{0, 1}, curvature{0, 0};
  for (std::size_t j = 2; j <= s; ++j) {
    t.push_back(2 * w0 * t[j - 1] - t[j - 2]);
    slope.push_back(2 * t[j - 1] + 2 * w0 * slope[j - 1] - slope[j - 2]);
    curvature.push_back(4 * slope[j - 1] + 2 * w0 * curvature[j - 1] - curvature[j - 2]);
  }
  const double w1 = slope[s] / curvature[s];
  std::vector<double> b(s + 1);
  for (std::size_t j = 2; j <= s; ++j) b[j] = curvature[j] / (slope[j] * slope[j]);
  b[0] = b[1] = b[2];
  std::vector<Stage> stages_of{{0, 0, b[1] * w1, 0}};
  for (std::size_t j = 2; j <= s; ++j) {
    const double rate = 2 * b[j] * w1 / b[j - 1];
    stages_of.push_back(
        {2 * b[j] * w0 / b[j - 1], -b[j] / b[j - 2], rate, -(1 - b[j - 1] * t[j - 1]) * rate});
  }
  return stages_of;
}

}  // namespace springstab
