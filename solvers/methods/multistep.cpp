#include "solvers/methods/multistep.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>

namespace springstab {
namespace {

constexpr double rounding = 1e-9;  // of coefficients as they are written in files

// Σ w_j j(j-1)...(j-n+1): how w meets the n-th derivative.
double moment(const std::vector<double>& w, int n) {
  double sum = 0;
  for (std::size_t j = 0; j < w.size(); ++j) {
    double term = w[j];
    for (int i = 0; i < n; ++i) term *= static_cast<double>(j) - i;
    sum += term;
  }
  return sum;
}

// What Σ w_j f(j) = Σ u_j f⁽ⁱ⁾(j) leaves of f = t^n, relative to its terms:
// Σ w_j j^n - n(n-1)...(n-i+1) Σ u_j j^(n-i).
double residual(const std::vector<double>& w, const std::vector<double>& u, int n, int i) {
  double sum = 0, factor = 1, size = 0;
  for (int l = 0; l < i; ++l) factor *= n - l;
  const auto power = [](std::size_t j, int e) { return e == 0 ? 1.0 : std::pow(static_cast<double>(j), e); };
  for (std::size_t j = 0; j < w.size(); ++j) {
    sum += w[j] * power(j, n);
    size += std::abs(w[j]) * power(j, n);
    if (n < i) continue;
    sum -= factor * u[j] * power(j, n - i);
    size += std::abs(factor * u[j]) * power(j, n - i);
  }
  return std::abs(sum) / std::max(size, 1.0);
}

[[noreturn]] void inconsistent(const std::string& what, double is, const std::string& expected) {
  std::ostringstream message;
  message.precision(12);
  message << "inconsistent: " << what << " is " << is << ", expected " << expected;
  throw std::invalid_argument(message.str());
}

void expect(const std::string& what, double is, double expected, const std::string& name) {
  if (std::abs(is - expected) <= rounding * std::max(1.0, std::abs(expected))) return;
  std::ostringstream value;
  value.precision(12);
  value << expected;
  inconsistent(what, is, name.empty() ? value.str() : name + ", which is " + value.str());
}

}  // namespace

bool is_implicit(const Multistep& m) {
  return m.beta.back() != 0 || (m.second_order && m.velocity_of_a.back() != 0);
}

void check_consistent(const Multistep& m) {
  expect("rho(1), the sum of alpha,", moment(m.alpha, 0), 0, "");
  if (moment(m.beta, 0) == 0) inconsistent("sigma(1), the sum of beta,", 0, "another number");
  if (!m.second_order) return expect("rho'(1)", moment(m.alpha, 1), moment(m.beta, 0), "sigma(1)");
  expect("rho'(1)", moment(m.alpha, 1), 0, "");
  expect("rho''(1)", moment(m.alpha, 2), 2 * moment(m.beta, 0), "2 sigma(1)");
  expect("the sum of 'x' of the velocity", moment(m.velocity_of_x, 0), 0, "");
  expect("the sum of j x_j of the velocity", moment(m.velocity_of_x, 1), 1, "");
}

// Of x exactly t^n the formula leaves nothing for n < p + its number of derivatives. The velocity at t = k is
// v_k = k^(n-1) n = Σ γ_j j^n + n(n-1) Σ δ_j j^(n-2).
int order_of(const Multistep& m) {
  const int derivatives = m.second_order ? 2 : 1;
  int order = 0;
  while (order < 8 && residual(m.alpha, m.beta, order + derivatives, derivatives) <= rounding) ++order;
  if (!m.second_order) return order;
  for (int n = 2; n <= order; ++n) {
    double sum = 0, size = 0;
    for (std::size_t j = 0; j < m.alpha.size(); ++j) {
      const double t = static_cast<double>(j), of_x = m.velocity_of_x[j] * std::pow(t, n),
                   of_a = m.velocity_of_a[j] * n * (n - 1) * (n == 2 ? 1.0 : std::pow(t, n - 2));
      sum += of_x + of_a;
      size += std::abs(of_x) + std::abs(of_a);
    }
    sum -= n * std::pow(static_cast<double>(m.steps()), n - 1);
    if (std::abs(sum) > rounding * std::max(size, 1.0)) return n - 1;
  }
  return order;
}

}  // namespace springstab
