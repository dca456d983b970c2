// How far stable powers grow first: against the conserved form of symplectic Euler, the double root of
// explicit Euler, and really taken steps.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>

#include "analysis/limits/transient_growth.h"
#include "solvers/linear/matrix_system.h"

BOOST_AUTO_TEST_SUITE(transient_growth)

using namespace springstab;
using boost::test_tools::tolerance;

namespace {

/// An oscillator of mass 1 with h = 1, so that d = X and k = Y.
MatrixSystem oscillator(double x, double y) {
  SparseMatrix k(1, 1), d(1, 1);
  k.insert(0, 0) = y;
  d.insert(0, 0) = x;
  return MatrixSystem(prepare(k, {}, d));
}

}  // namespace

// v² + Yx² + Yxv stays; with w = √Y x its eigenvalues are 1 ± √Y/2, and the powers turn along its ellipses.
BOOST_AUTO_TEST_CASE(symplectic_euler_moves_along_the_ellipses_that_it_conserves) {
  for (const double y : {0.37, 1.31, 3.1, 3.93}) {
    const double supremum = std::sqrt((1 + std::sqrt(y) / 2) / (1 - std::sqrt(y) / 2));
    const double growth = springstab::transient_growth("symplectic-euler", 0, y);
    BOOST_TEST(growth <= supremum * (1 + 1e-9));
    BOOST_TEST(growth >= supremum * (1 - 1e-3));
  }
}

BOOST_AUTO_TEST_CASE(what_loses_energy_at_every_step_never_grows) {
  for (const double y : {1e-3, 0.8, 7.9}) {
    BOOST_TEST(springstab::transient_growth("rk4", 0, y) == 1, tolerance(1e-12));
    for (const double x : {0.0, 0.3, 5.0})
      BOOST_TEST(springstab::transient_growth("implicit-euler", x, 100 * y) == 1, tolerance(1e-12));
  }
}

// Near the double root at (4, 4) the largest power grows like ε^(-1/2).
BOOST_AUTO_TEST_CASE(explicit_euler_grows_without_bound_towards_its_double_root) {
  const auto growth = [](double e) {
    return springstab::transient_growth("explicit-euler", 4 - 1.5 * e, 4 - 2 * e, 100'000);
  };
  const double far = growth(1e-2), near = growth(1e-4);
  BOOST_TEST(far > 5);
  BOOST_TEST(near / far == 10, tolerance(0.1));
}

// The energies of runs from many starts never exceed it, and some come near.
BOOST_AUTO_TEST_CASE(no_run_grows_more_and_some_do_as_much) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> angle(0, 7);
  const struct {
    const char* method;
    double x, y;
  } cases[] = {{"explicit-euler", 3.5, 3.3},
               {"explicit-euler", 0.011, 0.01},
               {"rk2", 2.0, 3.0},
               {"rk4", 5.2, 7.8},
               {"symplectic-euler", 0.1, 3.7}};
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.method << " at " << c.x << ", " << c.y) {
      MatrixSystem system = oscillator(c.x, c.y);
      const double growth = springstab::transient_growth(c.method, c.x, c.y);
      double largest = 0;
      for (int run = 0; run < 200; ++run) {
        const double a = angle(random);
        State<Vector> state{Vector::Constant(1, std::cos(a) / std::sqrt(c.y)),
                            Vector::Constant(1, std::sin(a))};
        const auto stepper = Method(c.method).stepper();
        for (int n = 0; n < 500; ++n) {
          stepper->step(system, 1, state);
          largest = std::max(largest, std::sqrt(c.y * state.x.squaredNorm() + state.v.squaredNorm()));
        }
      }
      BOOST_TEST(largest <= growth * (1 + 1e-12));
      BOOST_TEST(std::max(largest, 1.0) >= 0.99 * growth);
    }
}

BOOST_AUTO_TEST_CASE(a_line_of_modes_grows_as_its_worst_mode) {
  const double h = 1e-3, k0 = 3.9 / (h * h);
  const double worst = springstab::transient_growth("symplectic-euler", 0, 3.9);
  BOOST_TEST(springstab::transient_growth("symplectic-euler", {.k_max = k0}, h) == worst, tolerance(1e-12));
  const double k = 0.01 / (h * h), d0 = 0.004 / h, alpha = 0.7 * h;  // of one mode: X = 0.011
  BOOST_TEST(springstab::transient_growth("explicit-euler", {k, k, d0, alpha}, h) ==
                 springstab::transient_growth("explicit-euler", 0.011, 0.01),
             tolerance(1e-12));
  // The unit of time changes nothing.
  BOOST_TEST(springstab::transient_growth("symplectic-euler", {.k_max = 1e-18 * k0}, 1e9 * h) == worst,
             tolerance(1e-9));
  BOOST_TEST(!std::isfinite(springstab::transient_growth("symplectic-euler", 0, 1e8)));
}

BOOST_AUTO_TEST_SUITE_END()
