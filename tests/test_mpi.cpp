// springstab-mpi on one and two ranks: what the plain command says, and failures that end all with one line.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/command.h"
#include "tests/places.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(mpi)

using namespace springstab::test;
using Json = nlohmann::json;

namespace {

const Command here;

// As root and on fewer cores than ranks Open MPI wants to be told; others do not know these variables.
Outcome on(int ranks, const std::string& arguments) {
  const std::string program = command_path() + "-mpi";
  return here.shell(
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
      "OMPI_MCA_mpi_yield_when_idle=1 mpirun -q -np " +
      std::to_string(ranks) + " '" + program + "' " + arguments);
}

const Json& method(const Json& report, const std::string& name) {
  for (const Json& each : report["methods"])
    if (each["name"] == name) return each;
  throw std::runtime_error("no method " + name);
}

// Two numbers, or words, or nothing.
void check_same(const Json& a, const Json& b, double relative, const std::string& what) {
  if (a.is_number() && b.is_number()) {
    const double x = a, y = b;
    BOOST_TEST(std::abs(x - y) <= relative * std::abs(x), what << ": " << x << " and " << y);
  } else {
    BOOST_TEST(a == b, what);
  }
}

// Of each entry of a band a random one, symmetric and positive definite by its diagonal.
std::string banded(int n, int band, double scale, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  std::string text;
  int entries = 0;
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - band); j <= i; ++j, ++entries)
      text += std::to_string(i + 1) + ' ' + std::to_string(j + 1) + ' ' +
              std::to_string(scale * (i == j ? 2 * band + uniform(random) : -uniform(random))) + '\n';
  return "%%MatrixMarket matrix coordinate real symmetric\n" + std::to_string(n) + ' ' + std::to_string(n) +
         ' ' + std::to_string(entries) + '\n' + text;
}

std::vector<std::string> systems() {
  here.file("K.mtx", banded(211, 3, 1e4, 1));
  here.file("M.mtx", banded(211, 1, 0.3, 2));
  here.file("D.mtx", banded(211, 2, 5, 3));
  here.file("lumped.mtx", banded(211, 0, 0.2, 4));
  here.file("scene.json", R"({"geometry": {"grid": [14, 9], "spacing": 0.03},
    "material": {"name": "default", "damping": {"structural": 0.02, "shear": 0.01}},
    "pins": "0,4-6", "initial": {"stretch": [1.1, 1, 1.05]}, "damping": {"d0": 0.3, "alpha": 1e-5}})");
  const std::string scenes = "'" + source_folder() + "/experiments/scenes/";
  return {"--grid 21x30 --pin corners",
          "--grid 11x17 --material baraff-witkin --diagonals alternating --pin 0,5-9 --mass-total 0.4",
          "scene.json",
          scenes + "skirt.obj' --pin 0-20",
          scenes + "beam.veg'",
          "--stiffness K.mtx",
          "--stiffness K.mtx --mass lumped.mtx --damping-matrix D.mtx",
          "--stiffness K.mtx --mass M.mtx --rayleigh 3,1e-5"};
}

void check_agrees(const Json& plain, const Json& distributed) {
  for (const char* key : {"degrees_of_freedom", "symmetric", "stiffness_indefinite", "safety", "mesh"})
    BOOST_TEST(plain[key] == distributed[key], key);
  for (const char* key : {"kind", "d0", "alpha"})
    check_same(plain["damping"].value(key, Json()), distributed["damping"].value(key, Json()), 1e-10, key);
  check_same(plain["total_mass"], distributed["total_mass"], 1e-12, "total_mass");
  for (int axis = 0; plain["extent"].is_array() && axis < 3; ++axis)
    check_same(plain["extent"][axis], distributed["extent"][axis], 1e-12, "extent");
  const double k0 = distributed["k0"]["value"];
  check_same(plain["k0"]["value"], k0, 1e-8, "k0");
  check_same(plain["k0"]["bound"], distributed["k0"]["bound"], 0, "bound");
  check_same(plain["k0"]["upper_bound"], distributed["k0"]["upper_bound"], 1e-7, "upper bound");
  BOOST_TEST(distributed["k0"]["upper_bound"].get<double>() > k0);
  BOOST_TEST(distributed["mpi"]["eigenvalues_above_bound"] == 0);
  for (const Json& mine : distributed["methods"]) {
    const std::string name = mine["name"];
    const Json& theirs = method(plain, name);
    // Of damping that does not commute the plain command has all eigenvalues of systems as small as these.
    if (theirs["h_max_source"] != "estimate")
      for (const char* key : {"status", "h_max", "recommended_step"})
        check_same(theirs[key], mine[key], 1e-6, name + " " + key);
    const bool better = theirs["h_certified_source"] == "Lyapunov" || theirs["h_max_source"] == "estimate";
    if (!better) check_same(theirs["h_certified"], mine["h_certified"], 1e-6, name + " h_certified");
    if (mine["h_certified"].is_number() && theirs["h_max"].is_number())
      BOOST_TEST(mine["h_certified"].get<double>() <= theirs["h_max"].get<double>() * (1 + 1e-9), name);
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(ranks_say_what_the_plain_command_says) {
  for (const std::string& system : systems()) {
    const Outcome plain = here("limits " + system + " --json");
    for (const int ranks : {1, 2, 3}) BOOST_TEST_CONTEXT(system << " on " << ranks) {
        const Outcome outcome = on(ranks, "limits " + system + " --json");
        BOOST_TEST(outcome.status == plain.status, outcome.err);
        BOOST_TEST(outcome.err == plain.err);
        const Json report = outcome.json();
        BOOST_TEST(report["mpi"]["ranks"] == ranks);
        check_agrees(plain.json(), report);
      }
  }
}

// Where every spring has a damper, also by those methods whose regions touch the origin at an angle.
BOOST_AUTO_TEST_CASE(dampers_certify_every_method) {
  here.file("net.json", R"({"geometry": {"grid": [9, 8], "spacing": 0.1}, "pins": "first-row", "material":
    {"name": "default", "damping": {"structural": 0.02, "shear": 0.01, "bending": 0.004}}})");
  const Json plain = here("limits net.json --json").json();
  for (const int ranks : {1, 2}) {
    const Json report = on(ranks, "limits net.json --json").json();
    for (const char* name : {"explicit-euler", "rk2", "rk4", "symplectic-euler"}) BOOST_TEST_CONTEXT(name) {
        const double certified = method(report, name)["h_certified"];
        BOOST_TEST(certified <= method(plain, name)["h_max"].get<double>());
        BOOST_TEST(certified >= 0.9 * method(plain, name)["h_max"].get<double>());
      }
  }
}

// The exact limit where D' and K' do not commute, and a proof of it that is as sharp.
BOOST_AUTO_TEST_CASE(general_damping_has_its_exact_limit_and_polygons) {
  systems();
  for (const char* system : {"scene.json", "--stiffness K.mtx --mass lumped.mtx --damping-matrix D.mtx"}) {
    const Json plain = here(std::string("limits --json ") + system).json(),
               report = on(2, std::string("limits --json ") + system).json();
    BOOST_TEST(report["damping"]["kind"] == "general");
    const Json &exact = method(plain, "symplectic-euler"), &mine = method(report, "symplectic-euler");
    BOOST_TEST(mine["h_certified_source"] == "matrix condition");
    for (const char* key : {"h_max", "h_certified", "recommended_step"})
      check_same(exact[key], mine[key], 1e-6, key);
    const Json& rk4 = method(report, "rk4");
    BOOST_TEST(rk4["h_certified_source"] == "polygon");
    BOOST_TEST(rk4["h_certified"].get<double>() > 0.5 * method(plain, "rk4")["h_max"].get<double>());
    BOOST_TEST(method(report, "implicit-euler")["status"] == "unlimited");
  }
}

// Beyond one piece's size each rank proves its own, and what all of them prove is true and loses little.
BOOST_AUTO_TEST_CASE(pieces_bound_k0_from_above_with_the_loss_that_is_allowed) {
  const std::string net =
      "limits --grid 152x150 --pin first-row --method symplectic-euler --json --certify-loss ";
  const double k0 = here("limits --grid 152x150 --pin first-row --digits 8 --method symplectic-euler --json")
                        .json()["k0"]["value"];
  double looser = INFINITY;
  for (const double loss : {0.004, 0.001}) {
    double of_one = 0;
    for (const int ranks : {1, 2}) BOOST_TEST_CONTEXT(loss << " on " << ranks) {
        const Json report = on(ranks, net + std::to_string(loss)).json();
        BOOST_TEST(report["k0"]["bound"] == "pieces");
        BOOST_TEST(report["mpi"]["pieces"].get<int>() >= 2);
        BOOST_TEST(report["k0"]["digits"] == 4);
        const double bound = report["k0"]["upper_bound"], value = report["k0"]["value"];
        BOOST_TEST(bound > k0);
        BOOST_TEST(bound < k0 * (1 + 4 * loss));
        BOOST_TEST(value <= k0 * (1 + 1e-9));
        BOOST_TEST(value > k0 * (1 - 2e-4));
        if (ranks == 1) of_one = bound;
        if (ranks == 2) BOOST_TEST(bound < looser);
        if (ranks == 2) looser = std::max(bound, of_one);
      }
  }
}

BOOST_AUTO_TEST_CASE(petscs_binary_matrices_and_options_are_taken) {
  std::string binary;
  const auto put = [&](unsigned word) {
    for (int shift = 24; shift >= 0; shift -= 8) binary += static_cast<char>(word >> shift & 255);
  };
  const int n = 40;
  put(1211216), put(n), put(n), put(3 * n - 2);
  for (int i = 0; i < n; ++i) put(i == 0 || i == n - 1 ? 2 : 3);
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j) put(static_cast<unsigned>(j));
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j) {
      put(i == j ? 0x40000000 : 0xbff00000);  // 2 or -1
      put(0);
    }
  here.file("chain.petsc", binary);
  here.file("short.petsc", binary.substr(0, binary.size() - 8));
  const double s = std::sin(n * std::acos(-1.) / (2 * (n + 1)));
  for (const int ranks : {1, 2}) {
    const Outcome outcome = on(ranks, "limits --stiffness chain.petsc --json -eps_ncv 12 -log_view :log.txt");
    BOOST_TEST(outcome.status == 0, outcome.err);
    BOOST_TEST(outcome.json()["k0"]["value"].get<double>() == 4 * s * s, boost::test_tools::tolerance(1e-9));
    BOOST_TEST(content_of(here.folder() / "log.txt").find("EPSSolve") != std::string::npos);
    const Outcome ends_early = on(ranks, "limits --stiffness short.petsc");
    BOOST_TEST(ends_early.status == 2);
    BOOST_TEST(ends_early.err.starts_with("springstab-mpi: short.petsc: the file ends early"),
               ends_early.err);
  }
}

// Whoever finds it, on one rank or on all.
BOOST_AUTO_TEST_CASE(failures_are_one_line_and_exit_status_2) {
  systems();
  here.file("twice.mtx",
            "%%MatrixMarket matrix coordinate real general\n4 4 5\n1 1 1\n2 2 1\n3 3 1\n4 4 1\n4 4 2\n");
  here.file("word.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 two 1\n");
  here.file("askew.mtx",
            "%%MatrixMarket matrix coordinate real general\n3 3 4\n1 1 1\n2 2 1\n3 3 1\n3 1 1\n");
  here.file("massless.mtx", "%%MatrixMarket matrix coordinate real symmetric\n211 211 1\n1 1 1\n");
  here.file("contact.json", R"({"geometry": {"grid": [4, 4]},
    "contact": {"obstacles": [{"plane": {"point": [0, -1, 0], "normal": [0, 1, 0]}}], "thickness": 0.005}})");
  const std::pair<std::string, std::string> wrong[] = {
      {"--stiffness twice.mtx", "twice.mtx:7: a second entry (4, 4) after that of line 6"},
      {"--stiffness word.mtx", "word.mtx:4: 'two' is not an integer"},
      {"--stiffness askew.mtx", "the stiffness matrix is not symmetric (entry "},
      {"--stiffness none.mtx", "none.mtx: cannot be opened (No such file or directory)"},
      {"--stiffness scene.json", "scene.json:1: neither a Matrix Market banner nor a matrix in PETSc's"},
      {"--stiffness twice.mtx --sum-duplicates --mass K.mtx", "the mass matrix is 211 x 211, expected 4 x 4"},
      {"--stiffness K.mtx --mass massless.mtx", "the mass of unknown 2 is 0, expected a positive one"},
      {"--grid 5x5 --frobnicate", "unknown option '--frobnicate'"},
      {"--grid 5x5 --pin 99", "--pin: pinned particle 99 does not exist"},
      {"--grid 3x3 --pin 0-8", "--pin: all particles are pinned"},
      {"--grid 5x5 --explain", "--explain: is not served by springstab-mpi"},
      {"--grid 5x5 --method rk5", "unknown method 'rk5'"},
      {"--grid 5x5 --method implicit-damping-euler:part=diagonal", "--method: implicit-damping-euler"},
      {"contact.json", "contact.json: has contact, which is not served"},
      {"--grid 5x5 -eps_type nonsense", "rank 0: PETSc: Unknown EPS type given: nonsense"},
      {"", "input: nothing was given"}};
  for (const auto& [arguments, line] : wrong)
    for (const int ranks : {1, 2}) BOOST_TEST_CONTEXT(arguments << " on " << ranks) {
        const Outcome outcome = on(ranks, "limits --json " + arguments);
        BOOST_TEST(outcome.status == 2);
        BOOST_TEST(outcome.out.empty(), outcome.out);
        const auto begin = outcome.err.find("springstab-mpi: ");
        BOOST_TEST(outcome.err.starts_with("springstab-mpi: " + line), outcome.err);
        BOOST_TEST(outcome.err.find("springstab-mpi: ", begin + 1) == std::string::npos, outcome.err);
      }
}

BOOST_AUTO_TEST_CASE(without_a_stable_step_the_exit_status_is_3) {
  const Outcome outcome = on(2, "limits --grid 6x5 --method explicit-euler --json");
  BOOST_TEST(outcome.status == 3);
  BOOST_TEST(method(outcome.json(), "explicit-euler")["status"] == "none");
}

BOOST_AUTO_TEST_SUITE_END()
