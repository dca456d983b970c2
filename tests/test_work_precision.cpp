// Error against run time: the references are right and as precise as they say, orders show, costs are
// counted.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "analysis/errors/linear_motion.h"
#include "analysis/gsl/adaptive_integrator.h"
#include "analysis/method.h"
#include "experiments/inputs/scene_description.h"
#include "experiments/inputs/subject.h"
#include "experiments/studies/precision/contest.h"
#include "experiments/studies/precision/contest_figure.h"
#include "experiments/studies/precision/long_runs.h"
#include "experiments/studies/precision/scenes.h"
#include "solvers/io/input_error.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/spring_chain.h"
#include "tests/dense.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(work_precision)

using namespace springstab;
using springstab::test::random_vector;
namespace fs = std::filesystem;

namespace {

using boost::test_tools::tolerance;

const CommonOptions quiet{.quiet = true};

/// Masses and springs of all sizes.
SpringChain uneven_chain(RayleighDamping damping = {0.3, 0.02}) {
  return {{1, 2, 0.5, 4, 1.5}, {3, 10, 0.2, 7, 1, 20}, damping};
}

SceneDescription hung_cloth(double alpha = 1e-3) {
  SpringMaterial material;
  material.stiffness = {2, 1, 0.2};
  SceneDescription description;
  description.geometry = Grid{4, 4};
  description.material = material;
  description.pins = {.kind = Pins::Kind::first_row, .ranges = {}, .source = "test"};
  description.damping = {.d0 = 1, .alpha = alpha};
  description.initial.stretch = {1, 1, 1.1};
  return description;
}

Problem small_chain() {
  const double k = 400;
  return {"small chain", Model(SpringChain({1, 2, 1}, {k, 2 * k, k, k}, {0, 0}), Vector::Ones(3)), 1, quiet};
}

double gap(const State<Vector>& a, const State<Vector>& b) {
  return std::max((a.x - b.x).cwiseAbs().maxCoeff(), (a.v - b.v).cwiseAbs().maxCoeff());
}

}  // namespace

// --- the chain ---

BOOST_AUTO_TEST_CASE(a_chain_does_what_its_matrices_do) {
  SpringChain chain = uneven_chain();
  StructuralMatrices s = chain.matrices();
  s.damping = 0.3 * s.mass + 0.02 * s.stiffness;
  MatrixSystem matrices(s);
  const Vector x = random_vector(5, 1), v = random_vector(5, 2);
  const auto check_same = [](const Vector& a, const Vector& b) {
    BOOST_TEST(b.norm() > 0.1);
    BOOST_TEST((a - b).norm() <= 1e-13 * b.norm());
  };
  Vector a, b;
  chain.acceleration(x, v, a), matrices.acceleration(x, v, b), check_same(a, b);
  chain.stiffness_times(x, a), matrices.stiffness_times(x, b), check_same(a, b);
  chain.damping_times(x, a), matrices.damping_times(x, b), check_same(a, b);
  for (const Shift& shift : {Shift{1, 0.1, 0.01}, Shift{1, 3, 9}, Shift{2, 3, 9}, Shift{2, 0.7, 9}}) {
    BOOST_TEST((chain.solve_shifted(shift, x, a).status == StepStatus::done));
    matrices.solve_shifted(shift, x, b), check_same(a, b);
  }
  chain.set_damping({0, 0.5});  // what was factorized before does not count any more
  s.damping = 0.5 * s.stiffness;
  MatrixSystem damped(s);
  chain.solve_shifted({1, 3, 3 * 3}, x, a), damped.solve_shifted({1, 3, 3 * 3}, x, b), check_same(a, b);
  BOOST_TEST(chain.kinetic_energy(v) == matrices.kinetic_energy(v), tolerance(1e-14));
  BOOST_TEST(chain.potential_energy(x) == matrices.potential_energy(x), tolerance(1e-14));
}

BOOST_AUTO_TEST_CASE(an_impossible_chain_is_refused) {
  BOOST_CHECK_THROW(SpringChain({1, 1}, {1, 1}, {}), std::invalid_argument);
  BOOST_CHECK_THROW(SpringChain({}, {1}, {}), std::invalid_argument);
  BOOST_CHECK_THROW(SpringChain({1, 0}, {1, 1, 1}, {}), std::invalid_argument);
  BOOST_CHECK_THROW(SpringChain({1, 1}, {1, -1, 1}, {}), std::invalid_argument);
}

// --- references ---

// Under-, critically and overdamped, with a rigid and with an unstable mode: it obeys the equation of motion.
BOOST_AUTO_TEST_CASE(motion_in_closed_form_solves_the_equation_of_motion) {
  for (const auto& [d0, alpha, shift] :
       {std::tuple{0., 0., 0.}, {0.3, 0.02, 0.}, {30., 0., 0.}, {0., 5., 0.}, {2., 0., -1.5}}) {
    StructuralMatrices s = uneven_chain().matrices();
    for (int i = 0; i < 5; ++i) s.stiffness.coeffRef(i, i) += shift * s.mass.coeff(i, i);
    const State<Vector> start{random_vector(5, 1), random_vector(5, 2)};
    const LinearMotion motion(s, d0, alpha, start);
    BOOST_TEST(gap(motion.at(0), start) < 1e-14);
    s.damping = d0 * s.mass + alpha * s.stiffness;
    MatrixSystem system(s);
    const double t = 0.7, dt = 1e-3;
    const State<Vector> before = motion.at(t - dt), now = motion.at(t), after = motion.at(t + dt);
    Vector a;
    system.acceleration(now.x, now.v, a);
    const double size = std::max(a.norm(), 1e-3);
    BOOST_TEST(((after.x - before.x) / (2 * dt) - now.v).norm() < 1e-3 * std::max(now.v.norm(), size));
    BOOST_TEST(((after.v - before.v) / (2 * dt) - a).norm() < 1e-3 * size);
    const LinearMotion other(s, d0, alpha, start, 7);
    BOOST_TEST(gap(other.at(t), now) < 1e-12);
  }
}

// Critical damping is where the formulas for the two sides meet.
BOOST_AUTO_TEST_CASE(motion_in_closed_form_is_exact_at_critical_damping) {
  SpringChain one({1}, {4, 0}, {});
  const State<Vector> start{Vector::Constant(1, 0.5), Vector::Constant(1, -3)};
  for (double nearly : {0., 1e-9, -1e-9}) {
    const State<Vector> end = LinearMotion(one.matrices(), 4 + nearly, 0, start).at(1.5);
    const double mixed = start.v[0] + 2 * start.x[0];  // x = (x0 + (v0 + 2 x0) t) e^(-2t)
    BOOST_TEST(end.x[0] == (start.x[0] + mixed * 1.5) * std::exp(-3), tolerance(1e-8));
    BOOST_TEST(end.v[0] == (mixed - 2 * (start.x[0] + mixed * 1.5)) * std::exp(-3), tolerance(1e-8));
  }
}

BOOST_AUTO_TEST_CASE(integration_agrees_with_the_closed_form_to_its_tolerance) {
  SpringChain chain = uneven_chain();
  const State<Vector> start{random_vector(5, 1), random_vector(5, 2)};
  const LinearMotion motion(chain.matrices(), 0.3, 0.02, start);
  // A step's error is within the tolerance; more of them add up in methods of low order.
  for (const auto& [method, steps_add] : {std::pair{AdaptiveMethod::rk8pd, 100},
                                          {AdaptiveMethod::rkf45, 100},
                                          {AdaptiveMethod::bsimp, 100},
                                          {AdaptiveMethod::msbdf, 1000}}) {
    double before = 1;
    for (double eps : {1e-6, 1e-9}) {
      const AdaptiveResult result =
          integrate_adaptively(chain, start, {0.5, 2}, {.method = method, .tolerance = eps});
      BOOST_REQUIRE(result.finished);
      BOOST_REQUIRE(result.at.size() == 2u);
      const double off = std::max(gap(result.at[0], motion.at(0.5)), gap(result.at[1], motion.at(2)));
      BOOST_TEST(off < steps_add * eps);
      BOOST_TEST(off > 0);
      BOOST_TEST(off < std::max(before / 10, 10 * eps));  // extrapolation is better than asked
      before = off;
    }
  }
  long asked = 0;
  const AdaptiveResult stopped = integrate_adaptively(
      chain, start, {0.5, 2}, {.tolerance = 1e-12, .give_up = [&] { return ++asked > 30; }});
  BOOST_TEST(!stopped.finished);
  BOOST_TEST(stopped.force_evaluations == 30);
}

BOOST_AUTO_TEST_CASE(an_integration_says_how_far_it_came) {
  SpringChain chain = uneven_chain();
  const State<Vector> start{random_vector(5, 1), random_vector(5, 2)};
  for (double tolerance : {0.0, -1e-6, double{NAN}})
    BOOST_CHECK_THROW(integrate_adaptively(chain, start, {1}, {.tolerance = tolerance}),
                      std::invalid_argument);
  const AdaptiveResult nothing = integrate_adaptively(chain, start, {}, {});
  BOOST_TEST((nothing.finished && nothing.at.empty() && nothing.steps == 0));
  const State<Vector> nowhere{Vector::Constant(5, NAN), start.v};
  const AdaptiveResult lost = integrate_adaptively(chain, nowhere, {0.5, 2}, {});
  BOOST_TEST((!lost.finished && lost.at.empty()));
}

// Errors are relative to motion.
BOOST_AUTO_TEST_CASE(where_nothing_moves_there_is_no_reference) {
  SceneDescription description = hung_cloth();
  description.initial.stretch = {1, 1, 1};
  Problem falls("falls", Subject(description), 0.01, quiet);
  BOOST_TEST(reference_motion(falls, "").error.all_finite());
  Problem instant("instant", Subject(description), 1e-300, quiet);
  BOOST_CHECK_THROW(reference_motion(instant, ""), InputError);
  description.gravity.setZero();
  Problem rests("rests", Subject(description), 0.01, quiet);
  BOOST_CHECK_THROW(reference_motion(rests, ""), InputError);
  description.material = ClothMaterial{};  // moves by rounding errors
  Problem trembles("trembles", Subject(description), 0.01, quiet);
  BOOST_CHECK_THROW(reference_motion(trembles, ""), InputError);
}

// The same scene, nothing linear about it: RK4 at two small steps, extrapolated, knows nothing of the
// reference; neither is off by more than both say.
BOOST_AUTO_TEST_CASE(the_published_error_of_a_reference_is_honest) {
  Problem problem("cloth", Subject(hung_cloth()), 0.2, quiet);
  const Reference reference = reference_motion(problem, "");
  BOOST_TEST(reference.error.trajectory > 0);
  BOOST_TEST(reference.error.trajectory < 1e-8);
  const std::vector<Contestant> contestants = method_contestants(problem);
  const auto rk4 = std::ranges::find(contestants, "Runge-Kutta 4", &Contestant::name);
  const double h = problem.duration() / (16 * 64);
  Trajectory coarse = rk4->attempt(h, 100).trajectory, fine = rk4->attempt(h / 2, 100).trajectory;
  const double apart = errors_of(problem.system(), coarse, fine).trajectory;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    fine[i].x += (fine[i].x - coarse[i].x) / 15;
    fine[i].v += (fine[i].v - coarse[i].v) / 15;
  }
  // What is left of the extrapolated error is of order h⁵: less than a tenth of the fine one.
  const Errors off = errors_of(problem.system(), fine, reference.trajectory);
  BOOST_TEST(off.trajectory < reference.error.trajectory + apart / 10);
  BOOST_TEST(apart < 1e-6);
}

#ifdef SPRINGSTAB_ODEINT
// The cheap scenes of the figures: what the third integrator, of another family, is away is what was
// published. A closed form is good to rounding, and a few roundings more is the integrator.
BOOST_AUTO_TEST_CASE(a_third_integrator_agrees_with_every_reference) {
  const auto check = [](Problem problem) {
    const Reference reference = reference_motion(problem, "");
    const double allowed = reference.method.starts_with("closed form") ? 10 : 1;
    BOOST_TEST_CONTEXT(problem.title()) {
      BOOST_REQUIRE(reference.check);
      BOOST_TEST(reference.check->trajectory > 0);
      BOOST_TEST(reference.check->trajectory < allowed * reference.error.trajectory);
      BOOST_TEST((allowed == 1 || reference.error.trajectory < 1e-10));
    }
  };
  check(oscillator(quiet));
  check(uniform_chain(quiet));
  check(hanging_chain(1, quiet));
  check(hanging_chain(900, quiet));
  check(damped_net(1, quiet));
  check(tense_cloth(1, quiet));
  check(spring_drape(quiet));
}
#endif

BOOST_AUTO_TEST_CASE(both_kinds_of_reference_agree) {
  Problem problem = small_chain();
  const Reference exact = reference_motion(problem, "");
  const AdaptiveResult integrated =
      integrate_adaptively(problem.system(), problem.start(), {0.25, 1}, {.tolerance = 1e-12});
  BOOST_TEST(gap(integrated.at[0], exact.trajectory[4]) < 1e-9);
  BOOST_TEST(gap(integrated.at[1], exact.trajectory[16]) < 1e-9);
  BOOST_TEST(exact.error.trajectory < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_reference_is_kept_under_what_the_problem_does) {
  const test::ScratchFolder folder;
  Problem problem = small_chain();
  const Reference first = reference_motion(problem, folder.path());
  const fs::path file = folder.path() / fingerprint(problem);
  BOOST_REQUIRE(fs::exists(file));
  const auto written = fs::last_write_time(file);
  const Reference second = reference_motion(problem, folder.path());
  BOOST_TEST(second.error.trajectory == first.error.trajectory);
  for (std::size_t i = 0; i < first.trajectory.size(); ++i)
    BOOST_TEST(gap(first.trajectory[i], second.trajectory[i]) == 0);
  BOOST_CHECK(fs::last_write_time(file) == written);
  fs::resize_file(file, fs::file_size(file) - 8);  // a spoilt one is computed again
  const Reference third = reference_motion(problem, folder.path());
  BOOST_TEST(gap(third.trajectory.back(), first.trajectory.back()) == 0);

  const std::string same = fingerprint(problem);
  BOOST_TEST(fingerprint(problem) == same);
  const double k = 400;
  const auto other = [&](SpringChain chain, double x, double duration) {
    Problem changed("other", Model(std::move(chain), Vector::Constant(3, x)), duration, quiet);
    return fingerprint(changed);
  };
  BOOST_TEST(other({{1, 2, 1}, {k, 2 * k, k, k}, {0, 0}}, 1, 1) == same);
  BOOST_TEST(other({{1, 2, 1}, {k, 2 * k, k, k}, {0, 0}}, 1, 1 + 1e-15) != same);
  BOOST_TEST(other({{1, 2, 1}, {k, 2 * k, k, k}, {0, 0}}, 1 + 1e-15, 1) != same);
  BOOST_TEST(other({{1, 2, 1}, {k, 2 * k, k + 1e-9, k}, {0, 0}}, 1, 1) != same);
  BOOST_TEST(other({{1, 2, 1}, {k, 2 * k, k, k}, {0, 1e-9}}, 1, 1) != same);
  BOOST_TEST(other({{2, 4, 2}, {2 * k, 4 * k, 2 * k, 2 * k}, {0, 0}}, 1, 1) != same);  // heavier alike
}

// --- the contest ---

// Errors of order p fall by 2^p when the step is halved: at the two finest steps above rounding.
BOOST_AUTO_TEST_CASE(every_method_shows_its_order) {
  Problem linear("chain", Model(uneven_chain(), random_vector(5, 1)), 1, quiet);
  // Without alpha: linearized RK4 is of order 1 where the damping follows K(x).
  Problem cloth("cloth", Subject(hung_cloth(0)), 0.2, quiet);
  for (Problem* problem : {&linear, &cloth}) {
    const Reference reference = reference_motion(*problem, "");
    const std::vector<Contestant> contestants = method_contestants(*problem);
    for (const Method& each : all_methods()) {
      // On a linear system the frozen one is the system itself.
      const double order =
          each.info().linearized && problem->is_linear() && each.info().order == 2 ? 4 : each.info().order;
      const bool iterates = each.info().implicit && problem->scene();
      const std::string title = std::string(each.info().title) + (iterates ? " (CG 1e-08)" : "");
      const Contestant& contestant = *std::ranges::find(contestants, title, &Contestant::name);
      std::vector<double> orders;
      double coarse = 0;
      for (double h : std::span(contestant.settings).subspan(1, 9)) {
        const Attempt run = contestant.attempt(h, 100);
        if (run.outcome != Outcome::finished) continue;
        const double fine = errors_of(problem->system(), run.trajectory, reference.trajectory).trajectory;
        if (fine < 100 * reference.error.trajectory || fine < 1e-10) break;
        if (coarse > 0) orders.push_back(std::log2(coarse / fine));
        coarse = fine;
      }
      BOOST_TEST_REQUIRE(orders.size() >= 2u, each.name() << " has too few runs");
      for (double found : {orders[orders.size() - 2], orders.back()})
        BOOST_TEST_CONTEXT(each.name() << " on the " << problem->title()) {
          BOOST_TEST(found > order - 0.3);
          BOOST_TEST(found < order + 0.4);
        }
    }
  }
}

// Over thousands of steps 1.02 of a limit grows past any bound.
BOOST_AUTO_TEST_CASE(steps_straddle_the_limit_and_divergence_is_kept) {
  Problem problem("chain", Model(uneven_chain(), random_vector(5, 1)), 2000, quiet);
  const std::vector<Contestant> contestants = method_contestants(problem);
  for (const Method& each : all_methods()) {
    const Contestant& c = *std::ranges::find(contestants, each.info().title, &Contestant::name);
    BOOST_REQUIRE(c.limit);
    for (double h : c.settings) {
      const double steps = problem.duration() / h;
      BOOST_TEST(std::remainder(std::round(steps), trajectory_samples * 1.) == 0);
      BOOST_TEST(std::abs(steps - std::round(steps)) < 1e-6);
    }
    if (!std::isfinite(*c.limit)) continue;
    BOOST_TEST(c.settings[0] > *c.limit);
    BOOST_TEST(c.settings[1] < 0.991 * *c.limit);
    BOOST_TEST(c.settings[1] > 0.8 * *c.limit);
    const Attempt above = c.attempt(c.settings[0], 10), below = c.attempt(c.settings[1], 10);
    BOOST_TEST_CONTEXT(each.name()) {
      BOOST_CHECK(below.outcome == Outcome::finished);
      BOOST_TEST(below.trajectory.size() == trajectory_samples + 1u);
      BOOST_CHECK(above.outcome == Outcome::diverged);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_run_that_takes_too_long_is_said_to) {
  Problem problem = stiff_chain(quiet);
  const std::vector<Contestant> contestants = method_contestants(problem);
  const Contestant& rk4 = *std::ranges::find(contestants, "Runge-Kutta 4", &Contestant::name);
  const Attempt attempt = rk4.attempt(rk4.settings[1], 1e-3);
  BOOST_CHECK(attempt.outcome == Outcome::timed_out);
  BOOST_TEST(attempt.seconds > 0.9e-3);
  BOOST_TEST(attempt.steps > 0);
}

// 688 steps are as few as can be; of the end itself, not of the largest displacement, the error is 3.455e-7.
BOOST_AUTO_TEST_CASE(a_plain_rk4_is_precise_at_its_limit_on_the_uniform_chain) {
  Problem problem = uniform_chain(quiet);
  const std::vector<Contestant> contestants = method_contestants(problem);
  const Contestant& rk4 = *std::ranges::find(contestants, "Runge-Kutta 4", &Contestant::name);
  const Attempt run = rk4.attempt(rk4.settings[1], 10);
  BOOST_REQUIRE(run.trajectory.size() == trajectory_samples + 1u);
  BOOST_TEST(run.counts.force_evaluations == 4 * run.steps);
  Trajectory reference{problem.start()};
  const LinearMotion motion(problem.matrices(), problem.damping().d0, problem.damping().alpha,
                            problem.start());
  for (int i = 1; i <= trajectory_samples; ++i) reference.push_back(motion.at(i / 16.));
  const Errors errors = errors_of(problem.system(), run.trajectory, reference);
  BOOST_TEST(errors.position < 1e-6);
  BOOST_TEST(run.steps == 688);
  const State<Vector>& end = reference.back();
  const double relative = (run.trajectory.back().x - end.x).norm() / end.x.norm();
  BOOST_TEST(relative == 3.455e-7, tolerance(1e-2));
  BOOST_TEST(errors.position > 1e-8);
}

BOOST_AUTO_TEST_CASE(every_row_of_the_file_is_whole_and_nothing_is_not_a_number) {
  const test::ScratchFolder folder;
  Problem problem = small_chain();
  const ContestResult result = run_contest(problem, "", {.time_limit = 0.02, .repetitions = 5}, quiet);
  const std::string path = folder.path() / "runs.csv";
  write_runs(path, result);
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const auto columns = std::ranges::count(line, ',');
  long rows = 0, diverged = 0;
  while (std::getline(file, line)) {
    ++rows;
    BOOST_TEST(std::ranges::count(line, ',') == columns);
    BOOST_TEST(line.find("nan") == std::string::npos);
    if (line.find(",diverged,") != std::string::npos) {
      ++diverged;
      BOOST_TEST(line.find(",0,,,,,") != std::string::npos);  // not compared, and no errors
    }
  }
  long expected = 0;
  for (const ContestSeries& s : result.series) {
    expected += static_cast<long>(s.runs.size());
    for (const ContestRun& run : s.runs) {
      BOOST_TEST(run.seconds.size() == (run.compared ? 5u : 1u));
      if (run.compared) BOOST_TEST(run.errors->trajectory >= 100 * result.reference.error.trajectory);
    }
  }
  BOOST_TEST(rows == expected);
  BOOST_TEST(diverged > 0);

  const Cheapest one_percent = cheapest(result, 0.01, false), impossible = cheapest(result, 1e-300, false);
  BOOST_REQUIRE(one_percent.run);
  BOOST_TEST(one_percent.run->errors->trajectory <= 0.01);
  BOOST_TEST(!impossible.run);
}

// Fitted damping is another problem, and the error says so: it does not vanish with a designed step's α.
BOOST_AUTO_TEST_CASE(fitted_damping_is_measured_against_the_scenes_own) {
  Problem problem("cloth", Subject(hung_cloth()), 0.2, quiet);
  const std::vector<Contestant> own = method_contestants(problem);
  const Reference reference = reference_motion(problem, "");
  problem.design_damping();
  const std::vector<Contestant> designed = method_contestants(problem);
  const auto rk4 = [](const std::vector<Contestant>& list) {
    return *std::ranges::find(list, "Runge-Kutta 4", &Contestant::name);
  };
  const double h = rk4(own).settings[2];
  const auto error = [&](const Attempt& run) {
    BOOST_CHECK(run.outcome == Outcome::finished);
    problem.set_own_damping();
    return errors_of(problem.system(), run.trajectory, reference.trajectory).trajectory;
  };
  const double fitted = error(rk4(designed).attempt(h, 10));
  Problem same("cloth", Subject(hung_cloth()), 0.2, quiet);
  const double fixed = error(rk4(method_contestants(same)).attempt(h, 10));
  BOOST_TEST(fixed < fitted / 10);
  BOOST_TEST(fingerprint(problem) == fingerprint(same));  // the reference is the own one's
}

// --- long runs ---

// Undamped: explicit Euler and RK2 explode, symplectic Euler's energy stays where it is, RK4 and implicit
// Euler lose some.
BOOST_AUTO_TEST_CASE(energy_drifts_as_the_regions_say) {
  const EnergyDrift drift = energy_drift(3000, quiet);
  const auto of = [&](const char* name) {
    return *std::ranges::find(drift.curves, std::string(name), &EnergyCurve::name);
  };
  BOOST_TEST(drift.h * std::sqrt(drift.k0) == 1, tolerance(1e-12));
  for (const char* name : {"explicit Euler", "midpoint (RK2)", "linearized explicit Euler"})
    BOOST_TEST(of(name).diverged, name);
  for (const char* name : {"Runge-Kutta 4", "symplectic Euler", "implicit Euler"})
    BOOST_TEST(!of(name).diverged, name);
  BOOST_TEST(of("symplectic Euler").drift.back() < 0.2);
  BOOST_TEST(of("Runge-Kutta 4").drift.back() < 0.1);
  BOOST_TEST(of("implicit Euler").drift.back() > 0.9);
}

// An error of order p in the phase; symplectic Euler's is of order 1 because the damping is.
BOOST_AUTO_TEST_CASE(a_slow_mode_lags_by_the_methods_order) {
  for (const PhaseCurve& curve : phase_errors(quiet)) {
    BOOST_TEST_REQUIRE(curve.degrees.size() > 4u, curve.name);
    const bool fourth = curve.name.find("Kutta 4") != std::string::npos;
    const double order = fourth ? 4 : curve.name.find("RK2") != std::string::npos ? 2 : 1;
    std::size_t i = curve.degrees.size() - 1;
    while (i > 1 && curve.degrees[i] < 1e-9) --i;
    const double found = std::log2(curve.degrees[i - 1] / curve.degrees[i]);
    BOOST_TEST_CONTEXT(curve.name) {
      BOOST_TEST(found > order - 0.3);
      BOOST_TEST(found < order + 0.4);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
