// Closed forms of the methods on one mode, X = hd and Y = h²k with h = 1: what the literature says, so that
// tests can hold it against what a method's own step gives. Nothing outside the tests may use these.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iostream>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace springstab::oracles {

using Complex = std::complex<double>;

/// A random point, and its rounding unit.
struct Point {
  double x, y;
};
inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// h times the eigenvalues of the generator C = [[0, 1], [-Y, -X]]: z² + Xz + Y = 0, without cancellation.
inline std::array<Complex, 2> generator_eigenvalues(double x, double y) {
  const double discriminant = x * x - 4 * y;
  if (discriminant < 0)
    return {Complex(-x / 2, std::sqrt(-discriminant) / 2), Complex(-x / 2, -std::sqrt(-discriminant) / 2)};
  const double large = -(x + std::copysign(std::sqrt(discriminant), x)) / 2;
  return {Complex(large), Complex(large == 0 ? 0 : y / large)};
}

/// A method's closed form: R(z), if it has one, and the matrix A with a bound on the terms that each entry
/// sums up, so that an entry's rounding error is a few epsilons of that.
struct Oracle {
  std::string_view method;
  std::vector<double> taylor;      // R(z) = Σ taylor[j] z^j; empty where R is no polynomial
  Complex (*rational)(Complex z);  // R(z) where it is no polynomial; null where there is no R
  Eigen::Matrix2d (*closed_form)(double x, double y);
  Eigen::Matrix2d (*closed_form_size)(double x, double y);

  bool has_stability_function() const { return !taylor.empty() || rational; }

  Complex stability_function(Complex z) const {
    if (rational) return rational(z);
    Complex sum = 0;
    for (auto c = taylor.rbegin(); c != taylor.rend(); ++c) sum = sum * z + *c;
    return sum;
  }

  Eigen::Matrix2d matrix(double x, double y) const {
    return taylor.empty() ? closed_form(x, y) : series(Eigen::Matrix2d{{0, 1}, {-y, -x}});
  }
  Eigen::Matrix2d matrix_size(double x, double y) const {
    return taylor.empty() ? closed_form_size(x, y)
                          : series(Eigen::Matrix2d{{0, 1}, {std::abs(y), std::abs(x)}});
  }

  /// The two eigenvalues of A: R(z₁), R(z₂), or the roots of (λ-1)² + X(λ-1) + Yλ = 0 of symplectic Euler.
  std::array<Complex, 2> eigenvalues(double x, double y) const {
    if (!has_stability_function()) {
      const auto less_one = generator_eigenvalues(x + y, y);  // λ - 1 = u: u² + (X + Y)u + Y = 0
      return {1.0 + less_one[0], 1.0 + less_one[1]};
    }
    const auto z = generator_eigenvalues(x, y);
    return {stability_function(z[0]), stability_function(z[1])};
  }

 private:
  Eigen::Matrix2d series(const Eigen::Matrix2d& c) const {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (auto t = taylor.rbegin(); t != taylor.rend(); ++t) sum = sum * c + *t * Eigen::Matrix2d::Identity();
    return sum;
  }
};

/// Paper Eqs. 15, 18, 19 (as powers of the generator), 16, and the drift-kick form of symplectic Euler.
inline const std::vector<Oracle>& all() {
  static const std::vector<Oracle> table{
      {"explicit-euler", {1, 1}, nullptr, nullptr, nullptr},
      {"rk2", {1, 1, 1. / 2}, nullptr, nullptr, nullptr},
      {"rk4", {1, 1, 1. / 2, 1. / 6, 1. / 24}, nullptr, nullptr, nullptr},
      {"implicit-euler",
       {},
       [](Complex z) { return 1.0 / (1.0 - z); },
       [](double x, double y) {
         return Eigen::Matrix2d(Eigen::Matrix2d{{1 + x, 1}, {-y, 1}} / (1 + x + y));
       },
       [](double x,
          double y) {  // the method adds a change to the old velocity, and the denominator may cancel
         const double pole = 1 + x + y, sum = 1 + std::abs(x) + std::abs(y);
         return Eigen::Matrix2d(Eigen::Matrix2d::Ones() +
                                Eigen::Matrix2d{{std::abs(y), sum}, {std::abs(y), sum}} * sum /
                                    (pole * pole));
       }},
      {"symplectic-euler",
       {},
       nullptr,
       [](double x, double y) {
         return Eigen::Matrix2d{{1, 1}, {-y, 1 - x - y}};
       },
       [](double x, double y) {
         return Eigen::Matrix2d{{1, 1}, {std::abs(y), 1 + std::abs(x) + std::abs(y)}};
       }},
  };
  return table;
}

/// The oracle of a method, or null with a note: a method just added has none, and the laws that need none
/// hold it to account all the same.
inline const Oracle* find(std::string_view method) {
  for (const Oracle& oracle : all())
    if (oracle.method == method) return &oracle;
  std::cout << "note: no closed form of " << method << " in oracles.h, its step is compared with none\n";
  return nullptr;
}

/// λ = m ± √s, and how far rounding of a few epsilons of `size` in each entry can move it: √ of the error at
/// a double root, error / |λ₁ - λ₂| away from it.
struct Eigenvalues {
  std::array<Complex, 2> value;
  double error;
};

inline Eigenvalues eigenvalues(const Eigen::Matrix2d& a, const Eigen::Matrix2d& size) {
  const double m = (a(0, 0) + a(1, 1)) / 2, half = (a(0, 0) - a(1, 1)) / 2;
  const double s = half * half + a(0, 1) * a(1, 0);
  const double unit = 16 * epsilon;
  const double diagonal = unit * (size(0, 0) + size(1, 1));
  const double in_s = diagonal * (size(0, 0) + size(1, 1)) + 2 * unit * size(0, 1) * size(1, 0);
  const Complex root = std::sqrt(Complex(s));
  return {{m + root, m - root}, diagonal + std::min(std::sqrt(in_s), in_s / std::abs(root))};
}

/// The larger distance of the two pairs' best matching.
inline double distance(const std::array<Complex, 2>& a, const std::array<Complex, 2>& b) {
  const auto paired = [&](int i, int j) { return std::max(std::abs(a[0] - b[i]), std::abs(a[1] - b[j])); };
  return std::min(paired(0, 1), paired(1, 0));
}

}  // namespace springstab::oracles
