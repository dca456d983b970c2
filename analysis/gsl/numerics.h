// What the analysis takes from the GNU Scientific Library: functions of functions, without the library's
// types.
//
//     const double half_pi = root_between([](double t) { return std::cos(t); }, 1, 2);
//
// GSL is under the GNU General Public License, version 3; docs/licence.md says what that means for a binary.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace springstab {

using RealFunction = std::function<double(double)>;

/// The root of f in [a, b] to the last digits, by Brent's method; f(a) and f(b) differ in sign.
double root_between(const RealFunction& f, double a, double b);

/// The smallest value of f near b, to 1e-10 of its place, by Brent's method, where f(a) > f(b) < f(c); f(b)
/// where that does not hold.
double minimum_near(const RealFunction& f, double a, double b, double c);

struct Integral {
  double value = 0;
  double error = 0;       // estimated, absolute
  std::string failure{};  // why it is not to 1e-13, or to 1e-12 of its value; empty where it is
};

/// Of f over [a, b], by Gauss and Kronrod's rules of 15 and 31 points in at most 200 intervals.
Integral integral(const RealFunction& f, double a, double b);

/// All roots of c[0] + c[1] t + ..., whose last coefficient is not 0, from its companion matrix. Throws
/// std::runtime_error if they are not found.
std::vector<std::complex<double>> polynomial_roots(std::span<const double> c);

/// v = intercept + slope u, by least squares.
struct LineFit {
  double intercept, slope;
  double half_width;  // of the slope's 95 % confidence interval
};

/// Three points or more of two u or more; u and v are of one size.
LineFit fit_line(std::span<const double> u, std::span<const double> v);

}  // namespace springstab
