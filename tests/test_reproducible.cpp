// The same command gives the same bytes, whatever the number of threads, but for what a clock says; and what
// is random depends on the seed. (The long studies, divergence, complexity and work-precision, are held to
// the same in test_resume.cpp, where they are run over and over.)
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "analysis/method.h"
#include "tests/command.h"
#include "tests/results.h"

BOOST_FIXTURE_TEST_SUITE(reproducible, springstab::test::Command)

namespace fs = std::filesystem;
using springstab::Json;
using springstab::test::Command;
using springstab::test::content_of;
using springstab::test::files_in;
using springstab::test::Outcome;
using springstab::test::untimed;
using springstab::test::without_cheapest;

namespace {

struct Result {
  int status;
  std::string report;  // JSON without its times, or the text as it is
  std::map<std::string, std::string> files;

  bool operator==(const Result&) const = default;
};

// The command with its files in the folder `out`.
Result result_of(const Command& command, const std::string& arguments, const std::string& options = "") {
  const fs::path out = command.folder() / "out";
  fs::remove_all(out);
  fs::create_directories(out);
  const Outcome run = command(arguments + ' ' + options);
  const bool json = arguments.find("--json") != std::string::npos;
  return {run.status, json ? untimed(Json::parse(run.out)).dump() : without_cheapest(run.out), files_in(out)};
}

// With one thread twice, with two, and with three, which divide no number of cells here.
void expect_same_bytes(const Command& command, const std::string& arguments, std::size_t files) {
  BOOST_TEST_CONTEXT(arguments) {
    const Result first = result_of(command, arguments);
    BOOST_TEST(first.status == 0);
    BOOST_TEST(!first.report.empty());
    BOOST_TEST(first.files.size() == files);
    for (const char* threads : {"--threads 1", "--threads 2", "--threads 3"}) BOOST_TEST_CONTEXT(threads) {
        const Result again = result_of(command, arguments, threads);
        BOOST_TEST(again.report == first.report);
        BOOST_TEST((again == first));
      }
  }
}

const std::string net = R"({"geometry": {"grid": [7, 6]}, "pins": "first-row", )";

// A chain, as K; and forces that are not symmetric.
const char* chain =
    "%%MatrixMarket matrix coordinate real symmetric\n5 5 9\n"
    "1 1 2e4\n2 2 2e4\n3 3 2e4\n4 4 2e4\n5 5 2e4\n2 1 -1e4\n3 2 -1e4\n4 3 -1e4\n5 4 -1e4\n";
const char* rotor =
    "%%MatrixMarket matrix coordinate real general\n3 3 7\n"
    "1 1 900\n2 2 1000\n3 3 1100\n1 2 30\n2 1 -30\n2 3 20\n3 2 -20\n";

}  // namespace

// 61 x 47 and 23 x 23 cells: neither the eight lanes nor the threads divide them.
BOOST_AUTO_TEST_CASE(regions_do_not_depend_on_threads, *boost::unit_test::label("slow")) {
  for (const springstab::Method& info : springstab::all_methods()) {
    if (info.info().linearized) continue;  // the region of the method inside
    expect_same_bytes(*this,
                      "region " + std::string(info.name()) +
                          " --nx 61 --ny 47 --raster out/raster.csv --boundary out/boundary.csv --pieces "
                          "out/pieces.csv --simulate 23 --steps 500 --cells out/cells.csv --json",
                      4);
  }
  expect_same_bytes(*this, "region rk4 --nx 61 --ny 47", 0);
  expect_same_bytes(*this, "methods --json", 0);
  // More threads than cells are none too many, and other cells are not the same.
  const std::string few = "region rk4 --nx 3 --ny 1 --raster out/raster.csv --json";
  BOOST_TEST((result_of(*this, few, "--threads 64") == result_of(*this, few)));
  BOOST_TEST(!(result_of(*this, few, "--x 0:1") == result_of(*this, few)));
}

// Figures are drawn from cells that are really simulated.
BOOST_AUTO_TEST_CASE(figures_do_not_depend_on_threads) {
  const auto drawn = [&](const char* options) {
    Result result = result_of(*this, "figures 2 --quick --json --output out", options);
    for (auto& [name, content] : result.files) content = content_of(folder() / "out" / name);  // pictures too
    return result;
  };
  const Result first = drawn("");
  BOOST_TEST(first.status == 0);
  BOOST_TEST(first.files.size() == 5);
  for (const auto& [name, content] : first.files) BOOST_TEST(content.size() > 100);
  BOOST_TEST((drawn("--threads 1") == first));
  BOOST_TEST((drawn("--threads 3") == first));
}

BOOST_AUTO_TEST_CASE(limits_are_the_same_every_time, *boost::unit_test::label("slow")) {
  file("rayleigh.json", net + R"("damping": {"d0": 1, "alpha": 1e-4}})");
  file("damped.json", net + R"("material": {"damping": {"structural": 0.01, "shear": 0.01}}})");
  file("chain.mtx", chain);
  file("rotor.mtx", rotor);
  for (const std::string input :
       {"--grid 9x7 --pin first-row", "--grid 9x7 --material baraff-witkin", "rayleigh.json", "damped.json",
        "--stiffness chain.mtx", "--stiffness chain.mtx --damping-matrix chain.mtx", "--stiffness rotor.mtx"})
    expect_same_bytes(*this, "limits " + input + " --json", 0);
  expect_same_bytes(*this, "limits rayleigh.json", 0);
}

BOOST_AUTO_TEST_CASE(runs_are_the_same_every_time, *boost::unit_test::label("slow")) {
  file("stretched.json",
       net + R"("damping": {"d0": 1, "alpha": "designed"}, "initial": {"stretch": [3, 1, 3]}})");
  file("slack.json",
       net + R"("damping": {"d0": 1, "alpha": 0.001}, "initial": {"stretch": [0.97, 1, 0.97]}})");
  file("chain.mtx", chain);
  const std::string scene = " --duration 0.5 --frames 20 --json --output out";
  for (const springstab::Method& info : springstab::all_methods())
    expect_same_bytes(*this, "simulate stretched.json --method " + std::string(info.name()) + scene, 22);
  for (const char* solver : {"cg", "direct"})
    expect_same_bytes(
        *this,
        "simulate slack.json --method implicit-euler --step 0.005 --solver " + std::string(solver) + scene,
        22);
  expect_same_bytes(
      *this, "simulate --grid 6x5 --material baraff-witkin --pin corners --method rk4 --format vtk" + scene,
      22);
  expect_same_bytes(*this, "simulate --grid 6x5 --method linearized-rk4 --explain" + scene, 22);
  expect_same_bytes(*this, "simulate --stiffness chain.mtx --method rk4 --duration 1 --json --output out", 1);
}

// Large enough for their loops to be shared, and neither two nor three divide the particles.
BOOST_AUTO_TEST_CASE(large_runs_do_not_depend_on_threads) {
  const std::string grid =
      "simulate --grid 71x67 --pin first-row --json --output out --step 1e-4 --frames 3 ";
  for (const char* method : {"symplectic-euler", "linearized-rk4", "implicit-euler"})
    expect_same_bytes(*this, grid + "--duration 0.003 --method " + method, 5);
  expect_same_bytes(*this,
                    grid + "--duration 0.001 --material baraff-witkin --method linearized-explicit-euler", 5);
  expect_same_bytes(*this, "limits --grid 84x84 --pin first-row --method symplectic-euler --json", 0);
}

BOOST_AUTO_TEST_CASE(stress_cases_come_out_the_same_every_time, *boost::unit_test::label("slow")) {
  expect_same_bytes(*this, "stress --filter impulse --json --output out", 1);
}

// The start of a matrix system and the start vectors of eigenvalue searches are random. The first makes
// another motion; of the second k0 is independent within its residual, and a region has none.
BOOST_AUTO_TEST_CASE(what_is_random_depends_on_the_seed, *boost::unit_test::label("slow")) {
  file("chain.mtx", chain);
  const auto differ = [&](const std::string& arguments) {
    BOOST_TEST((result_of(*this, arguments, "--seed 1") == result_of(*this, arguments)));  // the default
    const Result one = result_of(*this, arguments, "--seed 1"), two = result_of(*this, arguments, "--seed 2");
    BOOST_TEST((two == result_of(*this, arguments, "--seed 2 --threads 3")));
    return std::pair(one.report != two.report, one.files != two.files);
  };
  const std::pair both(true, true), neither(false, false);
  BOOST_TEST((differ("simulate --stiffness chain.mtx --method rk4 --step 1e-3 --duration 1 --json --output "
                     "out") == both));
  BOOST_TEST((differ("simulate --grid 6x5 --method symplectic-euler --step 1e-4 --duration 0.1 --json "
                     "--output out") == neither));
  BOOST_TEST((differ("region rk4 --nx 20 --ny 20 --raster out/raster.csv --json") == neither));

  const std::string limits = "limits --grid 40x40 --json";  // too large for dense eigenvalues
  BOOST_TEST(differ(limits).first);
  const Json one = (*this)(limits).json().at("k0"), two = (*this)(limits + " --seed 2").json().at("k0");
  const double k0 = one.at("value"), other = two.at("value"), residual = one.at("residual");
  BOOST_TEST(residual > 0);
  BOOST_TEST(std::abs(k0 - other) <= residual + two.at("residual").get<double>());
}

BOOST_AUTO_TEST_SUITE_END()
