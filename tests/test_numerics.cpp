// What the analysis takes from GSL, on functions whose answers are known, and that an error of GSL is a
// status.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_poly.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <numbers>
#include <thread>
#include <vector>

#include "analysis/gsl/numerics.h"

BOOST_AUTO_TEST_SUITE(numerics)

using namespace springstab;

namespace {

constexpr double epsilon = 2.3e-16;

}  // namespace

BOOST_AUTO_TEST_CASE(a_root_is_found_to_the_last_digits) {
  const double root = root_between([](double t) { return std::cos(t); }, 1, 2.7);
  BOOST_TEST(std::abs(root - std::numbers::pi / 2) <= 4 * epsilon);
}

// f is flat at its minimum: a place that is off by δ changes the value by δ²/2, here (1e-10)²/2 and rounding.
BOOST_AUTO_TEST_CASE(a_minimum_has_the_value_at_its_place) {
  const auto f = [](double t) { return 3 - std::sin(t); };
  BOOST_TEST(std::abs(minimum_near(f, 0.2, 1.1, 2.9) - 2) <= 4 * epsilon);
  BOOST_TEST(minimum_near(f, 0.2, 0.1, 2.9) == f(0.1));  // no minimum is known to be near
}

BOOST_AUTO_TEST_CASE(an_integral_is_exact_or_says_why_not) {
  const Integral smooth = integral([](double t) { return std::cos(t); }, 0, 1);
  BOOST_TEST(smooth.failure.empty());
  BOOST_TEST(std::abs(smooth.value - std::sin(1)) <= 1e-12);
  const Integral none = integral([](double t) { return 1 / std::abs(t - 1. / 3); }, 0, 1);
  BOOST_TEST(!none.failure.empty());
}

// (t - 2)(t² + 9) = -18 + 9t - 2t² + t³
BOOST_AUTO_TEST_CASE(a_polynomial_has_its_real_and_complex_roots) {
  const std::vector<double> c{-18, 9, -2, 1};
  const auto roots = polynomial_roots(c);
  BOOST_REQUIRE(roots.size() == 3);
  for (const std::complex<double>& expected : {std::complex<double>(2, 0), {0, 3}, {0, -3}}) {
    double nearest = INFINITY;
    for (const auto& root : roots) nearest = std::min(nearest, std::abs(root - expected));
    BOOST_TEST(nearest <= 1e-14);
  }
  BOOST_CHECK_THROW(polynomial_roots(std::vector<double>{1}), std::invalid_argument);
  BOOST_CHECK_THROW(polynomial_roots(std::vector<double>{1, 0}), std::invalid_argument);
}

// Residuals 0.1 (1, -1, -1, 1) are orthogonal to 1 and u, so the line stays; s² = 0.04/2, Σ(u - ū)² = 5, and
// the quantile of Student's t with two degrees of freedom is q = √(2 p²/(1 - p²)) at the two-sided p = 0.95.
BOOST_AUTO_TEST_CASE(a_line_has_the_slope_and_its_confidence_interval) {
  const std::vector<double> u{0, 1, 2, 3}, v{1 + 0.1, 3 - 0.1, 5 - 0.1, 7 + 0.1};
  const LineFit line = fit_line(u, v);
  BOOST_TEST(std::abs(line.intercept - 1) <= 20 * epsilon);
  BOOST_TEST(std::abs(line.slope - 2) <= 20 * epsilon);
  const double q = std::sqrt(2 * 0.95 * 0.95 / (1 - 0.95 * 0.95));
  BOOST_TEST(std::abs(line.half_width / (q * std::sqrt(0.04 / 2 / 5)) - 1) <= 1e-9);
}

// GSL's own handler ends the process.
BOOST_AUTO_TEST_CASE(an_error_of_gsl_is_a_status_whichever_thread_asked_first) {
  std::vector<std::thread> threads;
  std::vector<int> status(4, GSL_SUCCESS);
  for (int& mine : status)
    threads.emplace_back([&mine] {
      const std::vector<double> parabola{-2, 0, 1}, degenerate{1, 0};
      polynomial_roots(parabola);
      gsl_poly_complex_workspace* const workspace = gsl_poly_complex_workspace_alloc(2);
      double z[2];
      mine = gsl_poly_complex_solve(degenerate.data(), 2, workspace, z);
      gsl_poly_complex_workspace_free(workspace);
    });
  for (std::thread& thread : threads) thread.join();
  for (int one : status) BOOST_TEST(one == GSL_EINVAL);
}

BOOST_AUTO_TEST_SUITE_END()
