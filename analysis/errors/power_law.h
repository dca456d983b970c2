// The law y = a x^b through measured points: how a cost grows, and how well that is known.
#pragma once

#include <span>

namespace springstab {

struct PowerLaw {
  double coefficient = 0;  // a
  double exponent = 0;     // b
  double half_width = 0;   // of the 95 % confidence interval of b (Student's t, points.size() - 2 degrees)

  double operator()(double x) const;
};

/// Least squares on the logarithms. Throws std::invalid_argument unless there are three or more points, as
/// many x as y, all positive and finite, and two different x.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

}  // namespace springstab
