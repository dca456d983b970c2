// How costs grow, and how k0 is found again: fits, the power method, and races whose counts no clock changes.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "analysis/errors/power_law.h"
#include "analysis/spectra/power_iteration.h"
#include "analysis/spectra/spectrum.h"
#include "experiments/studies/complexity/complexity_studies.h"
#include "experiments/studies/complexity/k0_watch.h"

BOOST_AUTO_TEST_SUITE(complexity)

using namespace springstab;

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
  BOOST_CHECK_THROW(fit_power_law(std::vector<double>{1, 2}, std::vector<double>{1, 2}),
                    std::invalid_argument);
}

namespace {

const CommonOptions quiet{.quiet = true};

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

// The stencil of the inner particles sets k0, and the sheet's edge takes away less the larger it is.
BOOST_AUTO_TEST_CASE(a_larger_drape_is_hardly_stiffer_and_k0_is_proportional_to_the_stiffness) {
  double before = 0;
  for (int side : {8, 16, 32, 64}) {
    const double k0 = k0_of({.side = side}, quiet).value;
    BOOST_TEST(k0 > before);
    if (before > 0) BOOST_TEST(k0 < 1.04 * before);
    before = k0;
  }
  const double k0 = k0_of({.side = 8}, quiet).value;
  BOOST_TEST(k0_of({.side = 8, .stiffness_factor = 100}, quiet).value == 100 * k0,
             boost::test_tools::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(a_race_counts_what_its_methods_are_known_to_take) {
  const Drape drape{.side = 8};
  const StiffestMode k0 = k0_of(drape, quiet);
  std::vector<Heat> heats;
  for (const Method& method : all_methods()) {
    const std::string name(method.name());
    heats.push_back({{name, name}, drape, k0, 0.05});
  }
  heats.push_back(
      {{"drag", "implicit-euler", DampingRule::drag, Preconditioner::block_jacobi}, drape, k0, 0.05});
  heats.push_back({{"leu", "implicit-euler", DampingRule::leu}, drape, k0, 0.05});
  const std::vector<HeatResult> first = race(heats, 3, quiet), second = race(heats, 1, quiet);
  double leu_alpha = 0;
  for (std::size_t i = 0; i < first.size(); ++i) BOOST_TEST_CONTEXT(heats[i].contestant.name) {
      const HeatResult& r = first[i];
      const Method method = heats[i].contestant.method;
      BOOST_TEST((r.finished && r.rollbacks == 0 && r.halved_steps == 0));
      BOOST_TEST(r.cpu_seconds.size() == 3);
      BOOST_TEST(r.h * static_cast<double>(r.steps) == 0.05, boost::test_tools::tolerance(1e-12));
      BOOST_TEST(r.counts.block_products == second[i].counts.block_products);
      BOOST_TEST(r.counts.force_evaluations == second[i].counts.force_evaluations);
      if (method.info().implicit) {
        BOOST_TEST(r.steps == 5);
        BOOST_TEST(r.counts.hessian_assemblies == 5);
        BOOST_TEST(r.counts.cg_iterations > 5);
      } else if (method.info().linearized) {
        BOOST_TEST(r.counts.hessian_assemblies == 5);
        BOOST_TEST(r.counts.force_evaluations == 5);
        BOOST_TEST(r.counts.block_products >= r.steps);
      } else {
        BOOST_TEST(r.counts.force_evaluations % r.steps == 0);
        BOOST_TEST(r.counts.hessian_assemblies == 0);
      }
      if (method.name() == "linearized-explicit-euler") leu_alpha = r.alpha;
    }
  BOOST_TEST(leu_alpha > 0);
  BOOST_TEST(first[first.size() - 2].alpha == 0);
  BOOST_TEST(first.back().alpha == leu_alpha);
}

BOOST_AUTO_TEST_CASE(medians_are_the_middle_one) {
  HeatResult result;
  for (double seconds : {3., 1., 20., 2.}) result.cpu_seconds.push_back(seconds);
  BOOST_TEST(result.median_seconds() == 2.5);
  result.cpu_seconds.push_back(0.5);
  BOOST_TEST(result.median_seconds() == 2);
}

// Every row has a number or a name in every column that its method fills.
BOOST_AUTO_TEST_CASE(a_study_writes_a_complete_row_for_every_run) {
  const StudyResult study = run_study(Study::time_step, true, quiet);
  BOOST_TEST(study.all_finished());
  for (const Series& series : study.series)
    for (std::size_t i = 1; i < series.points.size(); ++i) {  // the smaller the step, the more iterations
      BOOST_TEST(abscissa(study.study, series.points[i]) > abscissa(study.study, series.points[i - 1]));
      BOOST_TEST(series.points[i].counts.cg_iterations < series.points[i - 1].counts.cg_iterations);
    }
  const auto path = std::filesystem::temp_directory_path() / "springstab_complexity_runs.csv";
  write_runs(path.string(), study);
  std::ifstream file(path);
  std::string header, row;
  std::getline(file, header);
  const auto columns = [](const std::string& line) {  // commas within quotes do not count
    long count = 1;
    bool quoted = false;
    for (char c : line) {
      if (c == '"') quoted = !quoted;
      count += c == ',' && !quoted;
    }
    return count;
  };
  std::size_t rows = 0;
  while (std::getline(file, row)) {
    ++rows;
    BOOST_TEST(columns(row) == columns(header));
    BOOST_TEST((row.find(",,") == std::string::npos && row.find("nan") == std::string::npos));
  }
  BOOST_TEST(rows == study.series.size() * study.series[0].points.size() * 3);
  std::filesystem::remove(path);
}

// A Rayleigh quotient never exceeds the largest eigenvalue but for rounding and the reference's own error.
BOOST_AUTO_TEST_CASE(along_a_drape_warm_starts_find_k0_with_fewer_products) {
  const Drape drape{.side = 10};
  const std::vector<Moment> moments = moments_of(drape, "symplectic-euler", 0.1, 5, quiet);
  BOOST_TEST(moments.size() == 6);
  BOOST_TEST(moments.back().time == 0.1, boost::test_tools::tolerance(1e-9));
  const std::vector<K0Sample> samples = watch_k0(drape, moments, 1e-3, quiet);
  std::array<long, 4> products{};
  for (const K0Sample& sample : samples) {
    BOOST_TEST(std::abs(sample.k0 / samples[0].k0 - 1) < 0.01);  // hardly stretched: by a few 1e-4
    for (int way = 0; way < 4; ++way) {
      BOOST_TEST(sample.searches[way].converged);
      BOOST_TEST(sample.error(sample.searches[way]) < 1e-8);
      BOOST_TEST(sample.error(sample.searches[way]) > -1e-3);
      products[way] += sample.searches[way].products;
    }
  }
  BOOST_TEST(2 * products[1] < products[0]);
  BOOST_TEST(products[3] <= products[2]);
}

BOOST_AUTO_TEST_SUITE_END()
