// Arithmetic for loops over elements: three-vectors, 3x3 matrices and an arctangent made of nothing but
// additions, products, quotients, roots and selections, so that a loop whose body they form is vectorized by
// the compiler, one element a lane. Eigen's fixed-size types work on one element at a time instead.
#pragma once

#include <cmath>

namespace springstab {

/// Copied number by number: g++ does not vectorize a loop in which structures are copied whole.
struct Vec3 {
  double x, y, z;

  [[gnu::always_inline]] Vec3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  [[gnu::always_inline]] Vec3(const Vec3& other) : x(other.x), y(other.y), z(other.z) {}
  [[gnu::always_inline]] Vec3& operator=(const Vec3& other) {
    x = other.x, y = other.y, z = other.z;
    return *this;
  }
};

[[gnu::always_inline]] inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
[[gnu::always_inline]] inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
[[gnu::always_inline]] inline double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A 3x3 matrix by its rows.
struct Mat3 {
  Vec3 x, y, z;
};

[[gnu::always_inline]] inline Mat3 operator+(const Mat3& a, const Mat3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Mat3 operator-(const Mat3& a) { return {-a.x, -a.y, -a.z}; }
[[gnu::always_inline]] inline Mat3 operator*(double s, const Mat3& a) { return {s * a.x, s * a.y, s * a.z}; }
[[gnu::always_inline]] inline Mat3 transposed(const Mat3& a) {
  return {{a.x.x, a.y.x, a.z.x}, {a.x.y, a.y.y, a.z.y}, {a.x.z, a.y.z, a.z.z}};
}
[[gnu::always_inline]] inline Mat3 isotropic(double s) { return {{s, 0, 0}, {0, s, 0}, {0, 0, s}}; }
/// a bᵀ
[[gnu::always_inline]] inline Mat3 outer(const Vec3& a, const Vec3& b) { return {a.x * b, a.y * b, a.z * b}; }

/// The angle of the point (x, y), in [-π, π], as std::atan2 has it, to a relative error of 4 units of 2⁻⁵³
/// wherever |x| + |y| neither underflows nor overflows. Unlike std::atan2, it is not a number at (0, 0),
/// where there is no angle. The sign of a zero y counts (y = -0, x < 0: -π), that of a zero x does not.
///
/// With t = min(|x|, |y|) / max(|x|, |y|), atan t = π/4 + atan((t - 1)/(t + 1)) for t > tan(π/8), so that the
/// argument of the polynomial is at most tan(π/8); atan t = t + t³ P(t²), P of degree 9 with the least
/// relative error (Remez), 3.5e-17 of atan t.
[[gnu::always_inline]] inline double arctangent(double y, double x) {
  constexpr double pi = 3.141592653589793, pi_rest = 1.2246467991473532e-16;  // their sum is π to 32 digits
  constexpr double tan_eighth = 0.41421356237309503;                          // tan(π/8)
  const double ax = std::abs(x), ay = std::abs(y);
  const bool steep = ay > ax;
  const double low = steep ? ax : ay, high = steep ? ay : ax;
  const bool large = low > tan_eighth * high;
  const double t = (large ? low - high : low) / (large ? low + high : high);
  const double z = t * t, z2 = z * z, z4 = z2 * z2;
  const double p01 = -0.33333333333330218 + z * 0.1999999999910467;
  const double p23 = -0.14285714196526864 + z * 0.11111106703554938;
  const double p45 = -0.090907835283760894 + z * 0.076900833495724053;
  const double p67 = -0.066412461944072508 + z * 0.056931645041112872;
  const double p89 = -0.043608245019443882 + z * 0.021280131226142623;
  const double polynomial = p01 + z2 * p23 + z4 * (p45 + z2 * p67 + z4 * p89);
  const double octant = (t + t * (z * polynomial)) + (large ? pi_rest / 4 : 0);
  const double first = large ? pi / 4 + octant : octant;  // angle from the nearer axis, up to π/4
  const double quadrant = steep ? pi / 2 - (first - pi_rest / 2) : first;
  const double half = x < 0 ? pi - (quadrant - pi_rest) : quadrant;
  return std::copysign(half, y);
}

}  // namespace springstab
