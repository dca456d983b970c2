#include "analysis/proofs/proved_half_planes.h"

#include <cmath>

#include "analysis/constants.h"

namespace springstab {
namespace {

constexpr double excess = 1e-13;  // of a and b, which covers the rounding of λ

// Whether p + q, each a product that was rounded, is at least `wanted`.
bool reaches(double p, double q, double wanted) {
  return p + q - wanted >= 8 * unit_roundoff * (std::abs(p) + std::abs(q) + std::abs(wanted));
}

}  // namespace

void ProvedHalfPlanes::add(double c, double a, double b) { proved_.push_back({c, a, b}); }

// The least Σ λ_i c_i has as many λ_i > 0 as there are conditions that bind, those of a and b: two at most.
bool ProvedHalfPlanes::imply(double c, double a, double b) const {
  if (!(c >= 0 && std::isfinite(c) && std::isfinite(a) && std::isfinite(b))) return false;
  if (a <= 0 && b <= 0) return true;
  const auto suffice = [&](const Triple& p, double x, const Triple& q, double y) {
    return x >= 0 && y >= 0 && std::isfinite(x) && std::isfinite(y) && reaches(x * p.a, y * q.a, a) &&
           reaches(x * p.b, y * q.b, b) && (x * p.c + y * q.c) * (1 + 8 * unit_roundoff) <= c;
  };
  const double more_a = a + excess * std::abs(a), more_b = b + excess * std::abs(b);
  for (const Triple& p : proved_) {
    if (p.c <= c && p.a >= a && p.b >= b) return true;  // without rounding
    if (suffice(p, more_a / p.a, p, 0) || suffice(p, more_b / p.b, p, 0)) return true;
    for (const Triple& q : proved_) {
      const double determinant = p.a * q.b - p.b * q.a;
      const auto weigh = [&](double u, double v, double& x, double& y) {
        x = (u * q.b - v * q.a) / determinant;
        y = (v * p.a - u * p.b) / determinant;
      };
      double x = 0, y = 0;
      weigh(a, b, x, y);
      weigh(a + excess * (std::abs(x * p.a) + std::abs(y * q.a)),
            b + excess * (std::abs(x * p.b) + std::abs(y * q.b)), x, y);
      if (suffice(p, x, q, y)) return true;
    }
  }
  return false;
}

}  // namespace springstab
