// Integrators asked for nothing but steps: the methods of the list, at work on matrices, have the limits that
// their regions say and are known again; a program behind `probe` is no different.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>

#include "analysis/spectra/step_map.h"
#include "analysis/structure_limits.h"
#include "solvers/linear/matrix_system.h"
#include "tests/command.h"
#include "tests/places.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(step_map)

using namespace springstab;
using boost::test_tools::tolerance;
using springstab::test::Command;
using springstab::test::Outcome;

namespace {

// Springs of 100, 200 ... N/m between walls, and D = 0.3 M + 0.002 K.
StructuralMatrices structure(int n) {
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i <= n; ++i) {
    const double spring = 100 * (i + 1);
    if (i < n) k(i, i) += spring;
    if (i > 0) k(i - 1, i - 1) += spring;
    if (i > 0 && i < n) k(i, i - 1) = k(i - 1, i) = -spring;
  }
  const Eigen::MatrixXd d = 0.3 * Eigen::MatrixXd::Identity(n, n) + 0.002 * k;
  return prepare(k.sparseView(), {}, SparseMatrix(d.sparseView()));
}

StepMap map_of(MatrixSystem& system, const Method& method) {
  return {system.size(), [&system, method](double h, Vector& x, Vector& v) {
            State<Vector> state{x, v};
            const auto stepper = method.stepper();
            stepper->start(system, h, state);
            stepper->step(system, h, state);
            x = state.x, v = state.v;
          }};
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_methods_steps_have_its_limit_and_are_known_again) {
  const StructuralMatrices s = structure(5);
  StructureLimits answer(structure_of(s));
  MatrixSystem system(s);
  const Vector zero = Vector::Zero(system.size());
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const StepMap map = map_of(system, method);
      const LargestStep found = largest_stable_step(map, zero, zero);
      const double h = answer.limits(method).h_max.value();
      BOOST_REQUIRE(found.h_max.has_value());
      if (std::isinf(h))
        BOOST_TEST(std::isinf(*found.h_max));
      else
        BOOST_TEST(*found.h_max == h, tolerance(1e-4));
      const std::vector<MethodFit> fits = methods_that_fit(map, zero, zero, all_methods());
      BOOST_TEST(fits[0].distance < 1e-8);
      const auto its_own = std::ranges::find(fits, method, &MethodFit::method);
      BOOST_TEST(its_own->distance < 1e-8);
      if (!std::isinf(h)) BOOST_TEST(its_own->h_max.value() == h, tolerance(1e-6));
      for (const MethodFit& fit : fits)  // a linearized method takes the steps of the one inside
        if (method.name().find(fit.method.name()) == std::string::npos &&
            fit.method.name().find(method.name()) == std::string::npos)
          BOOST_TEST(fit.distance > same_eigenvalues);
    }
}

BOOST_AUTO_TEST_CASE(what_grows_at_every_step_has_no_largest) {
  MatrixSystem undamped(prepare(structure(4).stiffness));
  const Vector zero = Vector::Zero(4);
  for (const char* name : {"explicit-euler", "rk2"}) BOOST_TEST_CONTEXT(name)
  BOOST_TEST(!largest_stable_step(map_of(undamped, name), zero, zero).h_max.has_value());
  BOOST_TEST(largest_stable_step(map_of(undamped, "symplectic-euler"), zero, zero).h_max.has_value());
}

BOOST_AUTO_TEST_CASE(what_is_no_step_is_refused) {
  const Vector two = Vector::Zero(2), three = Vector::Zero(3);
  const StepMap shorter{2, [](double, Vector& x, Vector&) { x.resize(1); }};
  BOOST_CHECK_THROW(largest_stable_step(shorter, two, two), std::invalid_argument);
  BOOST_CHECK_THROW(largest_stable_step(shorter, three, three), std::invalid_argument);
  const StepMap nan{2, [](double, Vector& x, Vector&) { x[0] = std::numeric_limits<double>::quiet_NaN(); }};
  BOOST_TEST(!largest_stable_step(nan, two, two).h_max.has_value());
  BOOST_CHECK_THROW(step_eigenvalues(nan, two, two, 0.1, 1e-6), std::invalid_argument);
}

// x'' = -400 x by symplectic Euler, in Python: h = 0.1 is the limit.
BOOST_FIXTURE_TEST_CASE(a_program_is_asked_line_by_line, Command) {
  file("step.py", R"(import json, sys
for line in sys.stdin:
    now = json.loads(line)
    v = now["v"][0] - now["h"] * 400 * now["x"][0]
    print(json.dumps({"x": [now["x"][0] + now["h"] * v], "v": [v]}), flush=True)
)");
  const std::string program = " --json -- python3 step.py";
  const Outcome found = (*this)("probe --size 1 --claims symplectic-euler" + program);
  BOOST_REQUIRE(found.status == 0);
  BOOST_TEST(found.json()["h_max"].get<double>() == 0.1, tolerance(1e-5));
  BOOST_TEST(found.json()["method_that_fits"] == "symplectic-euler");
  BOOST_TEST(found.json()["is_what_it_claims"] == true);
  BOOST_TEST(found.json()["ratio"].get<double>() == 1, tolerance(1e-5));
  BOOST_TEST((*this)("probe --size 1 --claims rk4" + program).json()["is_what_it_claims"] == false);
}

// The examples, in three languages: n pendulums of 10 1/s², joined by 400 1/s², between walls.
BOOST_FIXTURE_TEST_CASE(the_examples_have_their_methods_limits, Command, *boost::unit_test::label("slow")) {
  const std::string probes = "'" + springstab::test::source_folder() + "/experiments/probes/";
  const auto has = [&](const std::string& line, const std::string& what) {
    if (shell(line + " >&2").status == 0) return true;
    BOOST_TEST_MESSAGE("skipped, for there is no " << what);
    return false;
  };
  const auto check = [&](const std::string& method, const std::string& program) {
    const Outcome found = (*this)("probe --json --size 3 --claims " + method + " -- " + program);
    BOOST_TEST_CONTEXT(program) {
      BOOST_REQUIRE_MESSAGE(found.status == 0, found.err);
      const double k0 = 10 + 400 * (2 + std::sqrt(2.0));
      if (method != "rk4")
        BOOST_TEST(found.json()["h_max"].get<double>() == 2 / std::sqrt(k0), tolerance(1e-5));
      BOOST_TEST(found.json()["is_what_it_claims"] == true);
      BOOST_TEST(found.json()["ratio"].get<double>() == 1, tolerance(1e-4));
    }
  };
  check("rk4", "python3 " + probes + "pendulums.py'");
  if (has("command -v node", "node")) check("symplectic-euler", "node " + probes + "pendulums.mjs'");
  if (has("c++ -std=c++17 -O0 " + probes + "pendulums.cpp' -o pendulums", "compiler with nlohmann's JSON"))
    check("velocity-verlet", "./pendulums");
}

// MuJoCo's steps, which were measured by runs of 6000 random steps. Its RK4 without damping: √8/√k0, so that
// it is also compared with what it claims.
BOOST_FIXTURE_TEST_CASE(the_engines_thresholds_are_found, Command) {
  const auto chain = test::shared_data("engines/mujoco_chain.json");
  if (!chain) return;
  if (shell("node -e 'require.resolve(\"mujoco-js\")' 2>/dev/null").status != 0) {
    BOOST_TEST_MESSAGE("skipped, for there is no npm package mujoco-js (NODE_PATH may name the folder)");
    return;
  }
  const auto measured = nlohmann::json::parse(test::content_of(*chain))["largest_stable_step"];
  const auto probed = [&](const std::string& claims, const std::string& words) {
    const Outcome found = (*this)("probe --json --size 9 --timeout 60 " + claims + " -- node '" +
                                  springstab::test::source_folder() +
                                  "/experiments/probes/mujoco_chain.mjs' '" + chain->string() + "' " + words);
    BOOST_REQUIRE_MESSAGE(found.status == 0, found.err);
    return found.json();
  };
  for (const auto& [key, words] :
       std::vector<std::pair<const char*, const char*>>{{"Euler, no damping", "Euler none"},
                                                        {"Euler, spring dampers", "Euler spring"},
                                                        {"Euler, joint dampers", "Euler joint"},
                                                        {"Euler, both", "Euler both"},
                                                        {"RK4, both", "RK4 both"},
                                                        {"implicitfast, both", "implicitfast both"},
                                                        {"implicit, both", "implicit both"}})
    BOOST_TEST_CONTEXT(key)
  BOOST_TEST(probed("", words)["h_max"].get<double>() == measured[key].get<double>(), tolerance(1e-4));
  const auto rk4 = probed("--claims rk4", "RK4 none");
  BOOST_TEST(rk4["h_max"].get<double>() == measured["RK4, no damping"].get<double>(), tolerance(1e-4));
  BOOST_TEST(rk4["is_what_it_claims"] == true);
  BOOST_TEST(rk4["ratio"].get<double>() == 1, tolerance(1e-4));
}

BOOST_FIXTURE_TEST_CASE(a_program_that_does_not_answer_gets_a_line, Command) {
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Outcome outcome = (*this)("probe " + arguments);
    BOOST_TEST_CONTEXT(arguments) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(outcome.out.empty());
      BOOST_TEST(outcome.err.find(words) != std::string::npos, outcome.err);
      BOOST_TEST(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    }
  };
  refused("--size 1 -- false", "exit status 1");
  refused("--size 1 --timeout 0.2 -- sleep 9", "within 0.2 s");
  refused("--size 1 -- ./none", "cannot be started");
  refused("--size 1 -- sh -c 'while read l; do echo no; done'", "no JSON");
  refused("--size 2 -- sh -c 'while read l; do echo \"{\\\"x\\\":[1],\\\"v\\\":[1]}\"; done'", "expected 2");
  refused("--size 1 -- sh -c 'while read l; do echo \"{\\\"x\\\":[null],\\\"v\\\":[1]}\"; done'",
          "x[0] is null");
  refused("-- cat", "--size, --state");
}

BOOST_AUTO_TEST_SUITE_END()
