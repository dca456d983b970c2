// Which method costs least: errors that are predicted against errors that are measured, choices where costs
// lie far apart, and runs that are to reach an error.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/errors/linear_motion.h"
#include "analysis/limits/cheapest_method.h"
#include "experiments/inputs/subject.h"
#include "tests/command.h"

BOOST_FIXTURE_TEST_SUITE(cheapest, springstab::test::Command)

using namespace springstab;
using springstab::test::Command;
using springstab::test::lines;
using springstab::test::Outcome;

namespace {

/// Uneven masses and springs, bent into a slow shape with some of everything else in it.
Model chain(int n, const RayleighDamping& damping) {
  std::vector<double> mass, stiffness;
  Vector x(n);
  for (int i = 0; i < n; ++i) {
    mass.push_back(1 + 0.3 * ((i * 7) % 5));
    x[i] = std::sin(3.0 * (i + 1) / (n + 1)) + 0.1 * ((i * 5) % 3);
  }
  for (int i = 0; i <= n; ++i) stiffness.push_back(1000 * (1 + 0.2 * ((i * 3) % 4)));
  return Model(SpringChain(mass, stiffness, damping), x);
}

/// Soft but for one spring, whose ends move as one.
Model stiff_chain() {
  const int n = 20;
  std::vector<double> stiffness(n + 1, 100);
  stiffness[10] = 1e12;
  Vector x(n);
  for (int i = 0; i < n; ++i) x[i] = std::sin(3.0 * (i + 1) / (n + 1));
  x[10] = x[9];
  return Model(SpringChain(std::vector<double>(n, 1), stiffness, {}), x);
}

using Trajectory = std::vector<Vector>;

/// Positions at the sixteen times, of `n` steps from one to the next; empty where a step fails.
Trajectory trajectory(Model& model, const Method& method, const State<Vector>& start, double duration,
                      long n) {
  const double h = duration / static_cast<double>(error_samples * n);
  const auto stepper = method.stepper();
  State<Vector> state = start;
  stepper->start(model.system(), h, state);
  if (method.info().linearized) stepper->restart(n);
  Trajectory samples;
  for (long i = 0; i < error_samples; ++i) {
    for (long j = 0; j < n; ++j)
      if (stepper->step(model.system(), h, state) != StepStatus::done) return {};
    samples.push_back(state.x);
  }
  return samples;
}

double error_of(Model& model, const Trajectory& run, const Trajectory& truth, const Vector& start) {
  BOOST_TEST_REQUIRE(run.size() == truth.size());
  double wrong = 0, moved = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    wrong += model.system().kinetic_energy(run[i] - truth[i]);
    moved += model.system().kinetic_energy(truth[i] - start);
  }
  return std::sqrt(wrong / moved);
}

Trajectory exact(Model& model, const RayleighDamping& damping, double duration) {
  const State<Vector> start = model.initial_state();
  const LinearMotion motion(model.structure(start).matrices, damping.d0, damping.alpha, start);
  Trajectory samples;
  for (long i = 1; i <= error_samples; ++i)
    samples.push_back(motion.at(duration * static_cast<double>(i) / static_cast<double>(error_samples)).x);
  return samples;
}

InputOptions grid(const std::string& size, const std::string& material = "", const std::string& pin = "") {
  InputOptions input;
  input.grid = size;
  input.material = material;
  input.pin = pin;
  return input;
}

InputOptions matrices(const std::filesystem::path& stiffness, const std::filesystem::path& damping = "") {
  InputOptions input;
  input.stiffness = stiffness;
  input.damping_matrix = damping;
  return input;
}

MotionSpectrum spectrum_of(Model& model) {
  const State<Vector> start = model.initial_state();
  return motion_spectrum(model, start, StructureLimits(model.structure(start)).k0().value);
}

const std::vector<Method> various{"symplectic-euler", "implicit-euler", "rk4", "newmark", "bdf2", "tr-bdf2"};

}  // namespace

// Of few unknowns the modes are all there is, and the prediction is the error itself; of many it is close.
BOOST_AUTO_TEST_CASE(a_predicted_error_is_the_measured_one) {
  const RayleighDamping damping{0.1, 1e-4};
  for (const int n : {25, 150}) {
    Model model = chain(n, damping);
    const MotionSpectrum motion = spectrum_of(model);
    const double duration = slowest_period(motion).value();
    const Trajectory truth = exact(model, damping, duration);
    const State<Vector> start = model.initial_state();
    for (const Method& method : various)
      for (const long steps : {40L, 160L})
        BOOST_TEST_CONTEXT(n << " unknowns, " << method.name() << ' ' << steps) {
          const double predicted = predicted_error(method, motion, duration, steps);
          const double measured =
              error_of(model, trajectory(model, method, start, duration, steps), truth, start.x);
          BOOST_TEST(measured > 1e-9);
          if (n < 30)
            BOOST_TEST(predicted == measured, boost::test_tools::tolerance(1e-5));
          else
            BOOST_TEST((predicted < 2 * measured && measured < 2 * predicted), predicted << ' ' << measured);
        }
  }
}

BOOST_AUTO_TEST_CASE(a_predicted_error_falls_with_the_order) {
  Model model = chain(25, {0.1, 1e-4});
  const MotionSpectrum motion = spectrum_of(model);
  const double duration = slowest_period(motion).value();
  for (const Method& method : various) BOOST_TEST_CONTEXT(method.name()) {
      const long n = method.info().order < 3 ? 2000 : 100;  // neither coarse nor lost in rounding
      const double order = std::log2(predicted_error(method, motion, duration, n) /
                                     predicted_error(method, motion, duration, 2 * n));
      BOOST_TEST(std::abs(order - method.info().order) < 0.1);
    }
}

BOOST_AUTO_TEST_CASE(a_step_for_an_error_is_the_largest) {
  Model model = chain(25, {0.1, 1e-4});
  const MotionSpectrum motion = spectrum_of(model);
  const double duration = slowest_period(motion).value();
  for (const Method& method : various)
    for (const double error : {0.02, 1e-3}) BOOST_TEST_CONTEXT(method.name() << ' ' << error) {
        const StepForError found = step_for_error(method, motion, {duration, error}, 0.02).value();
        const long n = std::lround(duration / error_samples / found.step);
        BOOST_TEST(found.step <= 0.02);
        BOOST_TEST(found.error == predicted_error(method, motion, duration, n));
        BOOST_TEST(found.error <= error);
        if (found.by_stability)
          BOOST_TEST(duration / (error_samples * static_cast<double>(n - 1)) > 0.02);
        else
          BOOST_TEST(predicted_error(method, motion, duration, n - 1 - n / 50) > error);
      }
}

// By factors of 1e3 and of 5 and more: no noise of a clock turns them round.
BOOST_AUTO_TEST_CASE(stiff_chains_get_an_implicit_method_and_soft_nets_an_explicit_one) {
  Model stiff = stiff_chain();
  const State<Vector> bent = stiff.initial_state();
  StructureLimits limits(stiff.structure(bent), {.max_step = 0.01});
  for (const std::optional<double> error : {std::optional<double>(), std::optional(0.1)}) {
    const CheapestMethod cheapest(limits, stiff, bent, all_methods(), {.error = error});
    BOOST_TEST_REQUIRE(cheapest.best());
    BOOST_TEST(cheapest.best()->method.name() == "implicit-euler");
    BOOST_TEST(cheapest.best()->error.value_or(0) <= error.value_or(1));
  }

  Subject net(grid("6x5", "soft", "first-row"));
  const State<Vector> start = net.initial_state();
  const double same = StructureLimits(net.structure(start)).limits("symplectic-euler").recommended.value();
  StructureLimits soft(net.structure(start), {.max_step = same});
  for (const std::optional<double> error : {std::optional<double>(), std::optional(0.05)}) {
    const CheapestMethod cheapest(soft, net, start, std::vector<Method>{"implicit-euler", "symplectic-euler"},
                                  {.error = error});
    BOOST_TEST_REQUIRE(cheapest.best());
    BOOST_TEST(cheapest.best()->method.name() == "symplectic-euler");
    BOOST_TEST(cheapest.second()->method.name() == "implicit-euler");
  }
}

BOOST_AUTO_TEST_CASE(substeps_are_the_fewest) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-5, 0), rates(1, 240);
  for (int i = 0; i < 2000; ++i) {
    const double rate = i % 2 == 0 ? rates(random) : 60;
    const double largest = i % 3 == 0 ? 1 / (60.0 * (1 + i % 50)) : std::pow(10, exponent(random));
    const Substeps found = substeps_of_frame(rate, largest);
    BOOST_TEST(found.number >= 1);
    BOOST_TEST(found.step <= largest);
    BOOST_TEST(found.step == 1 / (rate * static_cast<double>(found.number)));
    if (found.number > 1) BOOST_TEST(1 / (rate * static_cast<double>(found.number - 1)) > largest);
  }
  BOOST_CHECK_THROW(substeps_of_frame(1e-300, 1), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(what_rests_is_pushed_and_what_nothing_brings_back_has_no_period) {
  file("rest.json", R"({"geometry": {"grid": [5, 4]}, "pins": "first-row", "gravity": [0, 0, 0]})");
  InputOptions scene;
  scene.file = folder() / "rest.json";
  Subject rest(scene);
  BOOST_TEST(spectrum_of(rest).at_rest);
  BOOST_TEST(slowest_period(spectrum_of(rest)).has_value());
  Subject falling(grid("5x4"));  // all of it falls, and no spring is strained
  const MotionSpectrum motion = spectrum_of(falling);
  BOOST_TEST(!motion.at_rest);
  BOOST_TEST(!slowest_period(motion).has_value());
  BOOST_TEST(predicted_error("rk4", motion, 1, 100) < 1e-6);  // x = gt²/2
  BOOST_TEST(std::abs(predicted_error("symplectic-euler", motion, 1, 100) * 1600 - 1.25) < 0.05);
}

BOOST_AUTO_TEST_CASE(limits_name_the_cheapest_and_the_substeps) {
  const auto plain = (*this)("limits --grid 9x7 --pin first-row --json").json();
  auto asked = (*this)("limits --grid 9x7 --pin first-row --json --error 0.01 --frame-rate 60").json();
  BOOST_TEST(!plain.contains("cheapest"));  // what was not asked for is the same every time
  const auto framed = (*this)("limits --grid 9x7 --pin first-row --json --frame-rate 60").json();
  BOOST_TEST(framed["cheapest"].size() == 5);
  BOOST_TEST(framed["cheapest"]["method"].is_string());
  BOOST_TEST(framed["cheapest"]["error"].is_null());
  BOOST_TEST(asked["cheapest"]["error"].get<double>() <= 0.01);
  for (auto& method : asked["methods"]) BOOST_TEST_CONTEXT(method["name"]) {
      const auto& step = method["recommended_step"];
      BOOST_TEST(method["substeps"].is_null() == step.is_null());
      if (!step.is_null()) BOOST_TEST(method["frame_step"].get<double>() <= step.get<double>());
      const bool linearized = method["name"].get<std::string>().starts_with("linearized");
      BOOST_TEST(method["error_step"].is_null() == (step.is_null() || linearized));
      for (const char* key : {"substeps", "frame_step", "error_step", "predicted_error"}) method.erase(key);
    }
  BOOST_TEST(asked["methods"] == plain["methods"]);  // the rest is as it was

  const Outcome none =
      (*this)("limits --grid 9x7 --pin first-row --method explicit-euler --frame-rate 60 --json");
  BOOST_TEST(none.status == 3);
  BOOST_TEST(none.json()["cheapest"]["method"].is_null());
  BOOST_TEST(none.json()["cheapest"]["reason"] == "no step is known to be stable");
}

BOOST_AUTO_TEST_CASE(values_that_are_none_get_a_line) {
  const auto refused = [&](const std::string& arguments, const std::string& option) {
    const Outcome outcome = (*this)(arguments);
    BOOST_TEST_CONTEXT(arguments) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(outcome.out.empty());
      BOOST_TEST(lines(outcome.err) == 1);
      BOOST_TEST(outcome.err.find(option) != std::string::npos);
    }
  };
  for (const std::string value : {"0", "nan", "-1", "1", "inf"}) {
    refused("limits --grid 4x4 --error " + value, "--error");
    refused("simulate --grid 4x4 --duration 1 --error " + value, "--error");
  }
  for (const std::string value : {"0", "-1", "nan", "inf"})
    refused("limits --grid 4x4 --frame-rate " + value, "--frame-rate");
  const std::string run = "simulate --grid 4x4 --duration 1 ";
  refused(run, "--method");
  refused(run + "--error 0.1 --step 0.001", "--step");
  refused(run + "--error 0.1 --resume --output out", "--resume");
  refused(run + "--error 0.1 --method rk4 --methods all", "--methods");
  refused(run + "--method rk4 --methods all", "--methods");
}

// The run that was chosen, taken again here, against one of Runge and Kutta with steps so short that its
// own error counts for nothing.
BOOST_AUTO_TEST_CASE(runs_reach_their_error) {
  file("chain.mtx",
       "%%MatrixMarket matrix coordinate real symmetric\n5 5 9\n"
       "1 1 2e4\n2 2 2.1e4\n3 3 2e4\n4 4 2.2e4\n5 5 2e4\n2 1 -1e4\n3 2 -1e4\n4 3 -1e4\n5 4 -1e4\n");
  file("damper.mtx", "%%MatrixMarket matrix coordinate real symmetric\n5 5 1\n2 2 30\n");
  struct Case {
    InputOptions input;
    std::string arguments;
    double duration, error;
  };
  const std::vector<Case> cases{
      {grid("8x6", "", "first-row"), "--grid 8x6 --pin first-row", 0.1, 1e-3},
      {grid("5x4", "baraff-witkin", "first-row"), "--grid 5x4 --material baraff-witkin --pin first-row", 0.05,
       1e-2},
      {matrices(folder() / "chain.mtx"), "--stiffness chain.mtx", 0.3, 1e-3},
      {matrices(folder() / "chain.mtx", folder() / "damper.mtx"),
       "--stiffness chain.mtx --damping-matrix damper.mtx", 0.3, 1e-4},
  };
  for (const auto& [input, arguments, duration, error] : cases) BOOST_TEST_CONTEXT(arguments) {
      const Outcome outcome = (*this)("simulate " + arguments + " --duration " + std::to_string(duration) +
                                      " --error " + std::to_string(error) + " --json");
      BOOST_TEST_REQUIRE(outcome.status == 0);
      const auto report = outcome.json();
      BOOST_TEST(report["error"]["status"] == "reached");
      BOOST_TEST(report["counts"]["rollbacks"] == 0);
      const long steps = report["steps"];
      BOOST_TEST_REQUIRE(steps % error_samples == 0);
      Subject subject(input);
      const State<Vector> start = subject.initial_state();
      const long n = steps / error_samples;
      const double true_error =
          error_of(subject, trajectory(subject, report["method"].get<std::string>(), start, duration, n),
                   trajectory(subject, "rk4", start, duration, 40 * n), start.x);
      const double estimated = report["error"]["estimated"];
      BOOST_TEST(true_error <= 1.2 * error);
      BOOST_TEST((estimated < 2 * true_error && true_error < 2 * estimated), estimated << ' ' << true_error);
    }
}

BOOST_AUTO_TEST_CASE(a_miss_is_mended_once_or_said) {
  const std::string run =
      "simulate --grid 8x8 --pin corners --duration 0.2 --method linearized-rk4 --json --error ";
  const Outcome mended = (*this)(run + "0.01");
  BOOST_TEST(mended.status == 0);
  BOOST_TEST(mended.json()["error"]["runs"] == 2);  // frozen forces, which no linear system shows
  BOOST_TEST(mended.json()["error"]["estimated"].get<double>() <= 0.01);
  BOOST_TEST(lines(mended.err) >= 1);
  const Outcome none = (*this)("simulate --grid 4x4 --duration 1 --error 0.1 --method rk2 --json");
  BOOST_TEST(none.status == 3);
  BOOST_TEST(none.json()["step"].is_null());
}

BOOST_AUTO_TEST_SUITE_END()
