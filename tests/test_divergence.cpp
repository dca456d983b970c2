// Theory against simulation: what a study of cloth reports is what its runs did, and the examples explode.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>

#include "analysis/limits/step_limits.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/spectra/numerical_range.h"
#include "experiments/studies/divergence/cloth.h"
#include "experiments/studies/divergence/examples.h"
#include "tests/command.h"
#include "tests/random_nets.h"

BOOST_AUTO_TEST_SUITE(divergence)

using namespace springstab;

// The least factor whose recommended step is h: recommended_step undoes it.
BOOST_AUTO_TEST_CASE(the_safety_for_a_step_recommends_that_step, *boost::unit_test::label("slow")) {
  for (const char* method : {"explicit-euler", "rk4"}) {
    BOOST_TEST_CONTEXT(method) {
      const StabilityRegion& region = stability_region(method);
      const RayleighModes modes{0, 1e6, 1, 5e-4};
      const double limit = critical_step(region, modes);
      for (const double ratio : {0.9, 0.3}) {
        const auto safety = safety_for_step(region, modes, ratio * limit, 1e4);
        BOOST_REQUIRE(safety);
        BOOST_TEST(*safety > 1);
        const double step = recommended_step(region, modes, *safety);
        BOOST_TEST(step <= ratio * limit * (1 + 1e-9));
        BOOST_TEST(recommended_step(region, modes, *safety * (1 - 2e-4)) >= ratio * limit * (1 - 1e-9));
      }
      BOOST_TEST(*safety_for_step(region, modes, limit, 1e4) == 1);
      BOOST_TEST(!safety_for_step(region, modes, 1e-12, 1e4).has_value());
      // The unit of time changes nothing.
      const RayleighModes slower{0, 1e-12, 1e-9, 5e5};
      BOOST_TEST(*safety_for_step(region, slower, 0.5e9 * limit, 1e4) ==
                     *safety_for_step(region, modes, 0.5 * limit, 1e4),
                 boost::test_tools::tolerance(1e-3));
    }
  }
}

// A frozen cloth diverges above its limit and nowhere below; a hardly moving scene does as its linear system.
BOOST_AUTO_TEST_CASE(a_cloth_leaves_its_limits_where_theory_says, *boost::unit_test::label("slow")) {
  SceneDescription description;
  description.geometry = Grid{4, 4};
  description.pins.kind = Pins::Kind::first_row;
  Subject subject(description);
  ClothStudyOptions options;
  options.duration = 0.1;
  options.linear_steps = 1000;
  options.ratios = {0.6, 0.97, 1.4};
  const ClothStudy study = study_cloth("net", subject, options, [](double) {});
  BOOST_TEST(study.outside_band == 0);
  long below = 0, above = 0;
  for (const ClothRun& run : study.runs) {
    BOOST_TEST_CONTEXT(run.method << ", " << run.damping << ", " << run.ratio) {
      if (run.linear && run.ratio < 1) BOOST_TEST(!run.diverged);
      (run.diverged ? above : below) += 1;
      BOOST_TEST(run.steps > 0);
    }
  }
  BOOST_TEST(below > 20);
  BOOST_TEST(above > 15);
  for (const NeededSafety& needed : study.needed) {
    BOOST_TEST_CONTEXT(needed.method << ", " << needed.damping) {
      // Bounded up to the largest ratio before the first run of the scene that diverged.
      double bounded = 0;
      for (const ClothRun& run : study.runs)
        if (!run.linear && run.method == needed.method && run.damping == needed.damping) {
          if (run.diverged) break;
          bounded = run.ratio;
        }
      BOOST_TEST(needed.bounded_ratio.value_or(0) == bounded);
      BOOST_TEST((needed.k0_growth >= 1 && needed.k0_growth < 1.1));
      if (needed.factor) BOOST_TEST((*needed.factor >= 1 && *needed.factor < 4));
    }
  }
}

// And before the plane: its 10^8 cells of 10^6 steps would take days.
BOOST_FIXTURE_TEST_CASE(a_material_with_damping_is_refused_first, springstab::test::Command) {
  file("damped.json", R"({"geometry": {"grid": [3, 3], "spacing": 0.1}, "pins": [0],
                          "material": {"damping": {"structural": 1}}})");
  const springstab::test::Outcome refused =
      (*this)("divergence damped.json --cells 10000 --steps 1000000 --output results");
  BOOST_TEST(refused.status == 2);
  BOOST_TEST(refused.err ==
             "springstab: damped.json: has a material with damping, expected none: this study sets the "
             "damping\n");
  BOOST_TEST(!std::filesystem::exists(folder() / "results"));
}

BOOST_AUTO_TEST_CASE(steps_that_are_stable_each_grow_in_turn) {
  const Switching s = switching_oscillator();
  BOOST_TEST((s.radius_soft < 1 && s.radius_stiff < 1));
  // λ of the product of the four matrices [[1, 1], [-Y, 1 - X]], by hand, to the power of a quarter.
  BOOST_TEST(s.growth == 1.3160, boost::test_tools::tolerance(1e-3));
}

BOOST_AUTO_TEST_CASE(a_linearized_pendulum_explodes_where_symplectic_euler_swings) {
  const Pendulum p = swinging_pendulum();
  BOOST_REQUIRE(p.exploded_at.has_value());
  BOOST_TEST((*p.exploded_at > 0.2 && *p.exploded_at < 3));
  BOOST_TEST(p.symplectic_largest_energy < 1.1);
  BOOST_REQUIRE(p.samples.size() > 10u);
  for (const Pendulum::Sample& sample : p.samples) BOOST_TEST(std::isfinite(sample.linearized));
}

// The quadratic of what an eigenpair sees has its eigenvalue as a root, and W holds it.
BOOST_AUTO_TEST_CASE(eigenpairs_are_roots_of_what_they_see_and_lie_in_the_numerical_range) {
  test::RandomNets nets(9);
  for (int i = 0; i < 10; ++i) {
    const StructuralMatrices s = test::matrices(nets.net(true), 0.1);
    const std::vector<DampedMode> modes = damped_modes(s).value();
    const std::vector<std::complex<double>> spectrum = generator_spectrum(s).value();
    BOOST_REQUIRE_EQUAL(modes.size(), spectrum.size());
    const NumericalRange range(s);
    double fastest = 0;
    for (const std::complex<double> mu : spectrum) fastest = std::max(fastest, std::abs(mu));
    for (const double angle : {0.0, 0.7, 1.5, 2.2, 3.0, 4.1, 5.0, 5.9}) {
      const double a = std::cos(angle) * fastest, b = std::sin(angle);
      const ExtremePoint farthest = range.farthest(a, b).value();
      for (const DampedMode& m : modes) {
        BOOST_TEST(a * m.d + b * m.k <= a * farthest.d + b * farthest.k + 1e-9 * fastest * fastest);
        BOOST_TEST(std::abs(m.mu * m.mu + m.d * m.mu + m.k) <= 1e-9 * fastest * fastest);
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
