// A number with its derivatives by n variables, of first order or also of second, as the rules of
// differentiation carry them along:
//
//     const auto x = Jet<2, true>::variable(3, 0), y = Jet<2, true>::variable(4, 1);
//     const auto r = sqrt(x * x + y * y);  // r.value = 5, r.first = (3/5, 4/5), r.second = ∇²r
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace springstab {

template <int n, bool has_second>
struct Jet {
  static constexpr int m = has_second ? n : 0;

  double value;
  Eigen::Vector<double, n> first = Eigen::Vector<double, n>::Zero();
  Eigen::Matrix<double, m, m> second = Eigen::Matrix<double, m, m>::Zero();

  static Jet variable(double value, int which) {
    Jet jet{value};
    jet.first[which] = 1;
    return jet;
  }

  /// f(a), of which value and derivatives at a's value are these.
  static Jet chained(const Jet& a, double f, double f1, double f2) {
    Jet jet{f};
    jet.first = f1 * a.first;
    if constexpr (has_second) jet.second = f1 * a.second + f2 * a.first * a.first.transpose();
    return jet;
  }

  friend Jet operator+(const Jet& a, const Jet& b) {
    return {a.value + b.value, a.first + b.first, a.second + b.second};
  }
  friend Jet operator-(const Jet& a, const Jet& b) {
    return {a.value - b.value, a.first - b.first, a.second - b.second};
  }
  friend Jet operator*(const Jet& a, const Jet& b) {
    Jet jet{a.value * b.value};
    jet.first = a.value * b.first + b.value * a.first;
    if constexpr (has_second)
      jet.second = a.value * b.second + b.value * a.second + a.first * b.first.transpose() +
                   b.first * a.first.transpose();
    return jet;
  }
  friend Jet operator/(const Jet& a, const Jet& b) {
    const double inverse = 1 / b.value;
    return a * chained(b, inverse, -inverse * inverse, 2 * inverse * inverse * inverse);
  }
  friend Jet operator*(double s, const Jet& a) { return {s * a.value, s * a.first, s * a.second}; }
  friend Jet operator-(double s, const Jet& a) { return {s - a.value, -a.first, -a.second}; }
  friend Jet sqrt(const Jet& a) {
    const double root = std::sqrt(a.value);
    return chained(a, root, 0.5 / root, -0.25 / (a.value * root));
  }
};

}  // namespace springstab
