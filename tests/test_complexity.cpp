// How costs grow, and how k0 is found again: fits, the power method, and races whose counts no clock changes.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/power_iteration.h"
#include "analysis/power_law.h"
#include "analysis/spectrum.h"

using namespace springstab;

BOOST_AUTO_TEST_SUITE(complexity)

BOOST_AUTO_TEST_CASE(an_exact_power_law_is_found_again) {
  const std::vector<double> x{1e-3, 0.4, 7, 2e5};
  std::vector<double> y;
  for (double t : x) y.push_back(3.5 * std::pow(t, -1.25));
  const PowerLaw law = fit_power_law(x, y);
  BOOST_TEST(law.exponent == -1.25, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(law.coefficient == 3.5, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(law.half_width < 1e-12);
  BOOST_TEST(law(7) == y[2], boost::test_tools::tolerance(1e-12));
}

// Of 400 fits 95 % should cover the truth: 380 ± 4.4, so 360 to 398 is 4.5 deviations either way.
BOOST_AUTO_TEST_CASE(the_confidence_interval_covers_the_exponent_as_often_as_it_says) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0, 0.1);
  int covered = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> x, y;
    for (double t : {64., 256., 1024., 4096., 16384.}) {
      x.push_back(t);
      y.push_back(1e-6 * t * std::exp(noise(engine)));
    }
    const PowerLaw law = fit_power_law(x, y);
    covered += std::abs(law.exponent - 1) <= law.half_width;
  }
  BOOST_TEST(covered >= 360);
  BOOST_TEST(covered <= 398);
}

BOOST_AUTO_TEST_CASE(a_power_law_through_nothing_is_refused) {
  const std::vector<double> x{1, 2, 3};
  for (const std::vector<double>& y :
       {std::vector<double>{1, 2}, {1, 0, 2}, {1, -1, 2}, {1, std::nan(""), 2}, {1, INFINITY, 2}})
    BOOST_CHECK_THROW(fit_power_law(x, y), std::invalid_argument);
  BOOST_CHECK_THROW(fit_power_law(std::vector<double>{2, 2, 2}, x), std::invalid_argument);
}

namespace {

/// The diagonal matrix with eigenvalues 1 to n - 1 and one more.
LinearOperator diagonal(Eigen::Index n, double last) {
  Eigen::VectorXd d = Eigen::VectorXd::LinSpaced(n, 1, static_cast<double>(n));
  d[n - 1] = last;
  return {n, [d](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out = d.cwiseProduct(in); }};
}

}  // namespace

// The residual's vector is off by at most residual/gap, so the Rayleigh quotient by residual²/gap.
BOOST_AUTO_TEST_CASE(the_power_method_finds_what_arpack_finds) {
  const LinearOperator a = diagonal(300, 330);
  const SymmetricEigenpairs pairs = largest_eigenpairs(a, 1);
  const PowerIteration power = power_iteration(a, {.tolerance = 1e-4});
  BOOST_REQUIRE((pairs.converged && power.converged));
  BOOST_TEST(power.residual <= 1e-4 * power.value);
  BOOST_TEST(power.value <= pairs.values[0] * (1 + 1e-12));
  BOOST_TEST(pairs.values[0] - power.value <= power.residual * power.residual / (330 - 299));
  BOOST_TEST(std::abs(power.vector.dot(pairs.vectors.col(0))) > 1 - 1e-5);
}

BOOST_AUTO_TEST_CASE(the_power_method_says_when_it_has_not_converged) {
  const PowerIteration power = power_iteration(diagonal(300, 300), {.tolerance = 1e-6, .max_products = 20});
  BOOST_TEST(!power.converged);
  BOOST_TEST(power.products == 20);
  // ±λ of one modulus: the iteration turns to and fro for ever.
  BOOST_TEST(!power_iteration(diagonal(3, -2), {.tolerance = 1e-6, .max_products = 1000}).converged);
  BOOST_CHECK_THROW(power_iteration(diagonal(3, INFINITY)), std::invalid_argument);
  BOOST_CHECK_THROW(power_iteration(diagonal(3, 5), {.start = Eigen::VectorXd::Ones(2)}),
                    std::invalid_argument);
  BOOST_CHECK_THROW(power_iteration(diagonal(3, 5), {.start = Eigen::VectorXd::Zero(3)}),
                    std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(an_operator_that_has_changed_a_little_takes_fewer_products_from_the_old_vector) {
  const SymmetricEigenpairs before = largest_eigenpairs(diagonal(300, 305), 1, {.tolerance = 1e-6});
  const LinearOperator now = diagonal(300, 306);
  const Eigen::VectorXd old = before.vectors.col(0);
  BOOST_TEST(2 * power_iteration(now, {.start = old}).products < power_iteration(now).products);
  const SymmetricEigenpairs cold = largest_eigenpairs(now, 1, {.tolerance = 1e-6, .basis_size = 20});
  const SymmetricEigenpairs warm =
      largest_eigenpairs(now, 1, {.tolerance = 1e-6, .basis_size = 20, .start = old});
  BOOST_REQUIRE((cold.converged && warm.converged));
  BOOST_TEST(warm.products < cold.products);
  BOOST_TEST(warm.values[0] == 306, boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_SUITE_END()
