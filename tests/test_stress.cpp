// Stiff, extreme and hostile cases: what is cheap of the catalogue comes out as expected, and what does not
// is noticed.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <set>
#include <span>

#include "analysis/method.h"
#include "experiments/studies/stress/stress.h"
#include "tests/instruments.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(stress)

using namespace springstab;

namespace {

const CommonOptions quiet{.quiet = true};

}  // namespace

BOOST_AUTO_TEST_CASE(the_catalogue_has_cases_of_every_class_and_no_case_twice) {
  std::set<std::string> names, kinds;
  for (const StressCase& c : stress_catalogue()) {
    BOOST_TEST(names.insert(c.kind + c.name).second, c.kind << ", " << c.name << " is there twice");
    kinds.insert(c.kind);
  }
  BOOST_TEST(names.size() >= 60u);
  BOOST_TEST(kinds.size() >= 9u);
}

BOOST_AUTO_TEST_CASE(cheap_cases_come_out_as_expected) {
  const std::vector<const char*> filters{"structure", "mesh, ",     "time unit",     "stiffness, ",
                                         "scene, s",  "damping, c", "1.001 h_max, a"};
  for (const char* filter : std::span(filters).first(test::times(filters.size(), 2ul))) {
    const std::vector<StressResult> results = run_catalogue(filter, quiet);
    BOOST_TEST(!results.empty());
    for (const StressResult& r : results)
      BOOST_TEST(r.as_expected(), r.kind << ", " << r.name << ", " << r.method << ": expected "
                                         << name(r.expected) << ", came out " << name(r.outcome) << ": "
                                         << r.detail);
  }
}

// An expectation that fails is told; and what the error is measured by: half the time unit is another motion.
BOOST_AUTO_TEST_CASE(a_wrong_expectation_is_noticed) {
  const test::ScratchFolder folder;
  for (StressCase c : stress_catalogue()) {
    if (c.name != "k = 1") continue;
    c.expected = {StressOutcome::refused};
    std::optional<StiffestMode> k0;
    const StressResult result = run_stress(c, "rk4", folder.path(), quiet, k0);
    BOOST_TEST(!result.as_expected());
    BOOST_TEST((result.outcome == StressOutcome::right));
    BOOST_REQUIRE(result.error);
    BOOST_TEST(*result.error > 0);
    BOOST_TEST(*result.error < 1e-6);  // (√k h)⁴ is 1e-7
  }
}

// Steps of 1/100 of the motion in any unit of time: the same run, to rounding.
BOOST_AUTO_TEST_CASE(a_time_unit_changes_no_error) {
  const std::vector<StressResult> results = run_catalogue("time unit", quiet);
  const std::size_t methods = all_methods().size();
  for (std::size_t i = methods; i < results.size(); ++i) {
    const StressResult &first = results[i % methods], &other = results[i];
    BOOST_TEST(other.steps == first.steps);
    BOOST_TEST(std::abs(*other.error - *first.error) <= 1e-9);
  }
}

// Kinetic energy out of a potential one below zero shows that the structure itself grows: no divergence.
BOOST_AUTO_TEST_CASE(the_watch_leaves_a_structure_that_grows_by_itself) {
  const EnergyWatch passive{.initial_energy = 1, .largest_gain = 1},
      active{.initial_energy = 1, .largest_gain = 1, .may_grow = true};
  BOOST_TEST(passive.diverged(1e7, 1));
  BOOST_TEST(passive.gained(3, 1));
  BOOST_TEST(!passive.grows(1e7, -1e7));
  BOOST_TEST(active.grows(1e7, -1e7));
  BOOST_TEST(!active.grows(1e7, 1e7));
  for (double not_finite : {double{INFINITY}, double{NAN}}) {
    BOOST_TEST(active.diverged(not_finite, 1));
    BOOST_TEST(!active.grows(not_finite, -not_finite));
  }
}

BOOST_AUTO_TEST_SUITE_END()
