#include "analysis/errors/power_law.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/gsl/numerics.h"

namespace springstab {
namespace {

std::vector<double> logarithms(std::span<const double> values) {
  std::vector<double> logs;
  for (double value : values) {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument("a power law cannot pass through " + std::to_string(value) +
                                  ", expected positive finite numbers");
    logs.push_back(std::log(value));
  }
  return logs;
}

}  // namespace

double PowerLaw::operator()(double x) const { return coefficient * std::pow(x, exponent); }

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 3)
    throw std::invalid_argument("a power law through " + std::to_string(x.size()) + " x and " +
                                std::to_string(y.size()) + " y, expected three or more of both");
  const std::vector<double> u = logarithms(x), v = logarithms(y);
  if (const auto [least, most] = std::ranges::minmax(u); !(least < most))
    throw std::invalid_argument("a power law through points of one x, expected two or more");
  const LineFit line = fit_line(u, v);
  return {std::exp(line.intercept), line.slope, line.half_width};
}

}  // namespace springstab
