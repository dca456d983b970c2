// How the command treats its user: sizes and units are told, what is too long or without use as well, a word
// that is nearly right is recognized, nothing that was kept is lost unasked, progress leaves no trace.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/command.h"
#include "tests/places.h"

BOOST_FIXTURE_TEST_SUITE(manners, springstab::test::Command)

namespace fs = std::filesystem;
using Json = nlohmann::json;
using springstab::test::Command;
using springstab::test::content_of;
using springstab::test::Outcome;

namespace {

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

bool close(const Json& value, double expected, double tolerance = 1e-9) {
  return value.is_number() && std::abs(value.get<double>() - expected) <= tolerance * std::abs(expected);
}

// A strip of 3 x 2 vertices, `unit` apart in x and twice that in z.
std::string strip(double unit) {
  std::string mesh;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j)
      mesh += "v " + std::to_string(j * unit) + " 0 " + std::to_string(2 * i * unit) + '\n';
  return mesh + "f 1 2 5 4\nf 2 3 6 5\n";
}

// What is seen on a terminal of a command's stdout and stderr.
std::string on_terminal(const fs::path& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "springstab");
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  int terminal = -1;
  const pid_t process = forkpty(&terminal, nullptr, nullptr, nullptr);
  BOOST_REQUIRE(process >= 0);
  if (process == 0) {
    if (chdir(folder.c_str()) == 0) execv(springstab::test::command_path().c_str(), words.data());
    _exit(127);
  }
  std::string seen;
  char buffer[4096];
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) seen.append(buffer, n);
  int status = 0;
  waitpid(process, &status, 0);
  ::close(terminal);
  return seen;
}

// What stands there in the end, when each \r\033[K has erased its line.
std::string left_on(const std::string& terminal) {
  std::string text = terminal;
  for (std::size_t erase; (erase = text.find("\r\033[K")) != std::string::npos;) {
    const std::size_t line = text.rfind('\n', erase) + 1;  // npos + 1 = 0
    text.erase(line, erase + 4 - line);
  }
  return text;
}

}  // namespace

BOOST_AUTO_TEST_CASE(extent_mass_and_springs_are_told) {
  file("strip.obj", strip(0.1));
  for (const std::string& command :
       {std::string("limits strip.obj --pin 0"),
        std::string("simulate strip.obj --pin 0 --duration 0.01 --method rk4")}) {
    const Json report = (*this)(command + " --json").json();
    BOOST_REQUIRE(report["extent"].size() == 3);
    BOOST_TEST(close(report["extent"][0], 0.2));
    BOOST_TEST(report["extent"][1] == 0.0);
    BOOST_TEST(close(report["extent"][2], 0.2));
    BOOST_TEST(close(report["total_mass"], 0.2 * 0.2 * 0.2));  // 0.2 kg/m²
    BOOST_TEST(report["springs"] == 7 + 4 + 2);                // edges, diagonals, along the rows
    BOOST_TEST(has((*this)(command).out, "0.2 x 0 x 0.2 m, 0.008 kg, 13 springs\n"));
  }
  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 100\n2 2 50\n");
  const Json matrices = (*this)("limits --stiffness k.mtx --json").json();
  for (const char* key : {"extent", "total_mass", "springs"})
    BOOST_TEST((matrices.contains(key) && matrices[key].is_null()));
}

BOOST_AUTO_TEST_CASE(lengths_that_are_no_metres_are_told_and_scaled) {
  file("m.obj", strip(0.1));
  file("mm.obj", strip(100));
  file("km.obj", strip(0.0001));
  file("mm.json", R"({"geometry": {"mesh": "mm.obj"}, "scale": 0.001, "pins": [0]})");
  file("in.json", R"({"geometry": {"mesh": "mm.obj", "scale": 0.001}, "pins": [0]})");
  file("raw.json", R"({"geometry": {"mesh": "mm.obj"}, "pins": [0]})");
  const std::string as = " --method rk4 --json";
  const Outcome metres = (*this)("limits m.obj --pin 0" + as);
  BOOST_TEST(metres.err == "");
  for (const std::string same :
       {"mm.obj --scale 0.001 --pin 0", "mm.json", "in.json", "raw.json --scale 1e-3"}) {
    const Outcome scaled = (*this)("limits " + same + as);
    BOOST_TEST(scaled.err == "", same << ": " << scaled.err);
    BOOST_TEST(close(scaled.json()["k0"]["value"], metres.json()["k0"]["value"].get<double>()));
    BOOST_TEST(close(scaled.json()["total_mass"], 0.008));
  }
  for (const std::string command : {"limits mm.obj --pin 0", "simulate mm.obj --pin 0 --duration 1"}) {
    const Outcome warned = (*this)(command + as);
    BOOST_TEST(has(warned.err, "warning: mm.obj: is 200 m across, more than 20 m"), warned.err);
    BOOST_TEST(has(warned.err, "--scale 0.001"));
    BOOST_TEST(has(warned.err, "exceeds a twentieth of the time in which a particle falls"), warned.err);
  }
  const Outcome tiny = (*this)("limits km.obj --pin 0" + as);
  BOOST_TEST(has(tiny.err, "is 0.0002 m across, less than 1 mm"), tiny.err);
  BOOST_TEST(close((*this)("limits --grid 4x5 --scale 2" + as).json()["extent"][0], 4 * 0.05));
  // Both sides of the borders.
  BOOST_TEST((*this)("limits --grid 2x2 --spacing 19.9" + as).err.find("more than") == std::string::npos);
  BOOST_TEST(has((*this)("limits --grid 2x2 --spacing 20.1" + as).err, "more than 20 m"));
  BOOST_TEST((*this)("limits --grid 2x2 --spacing 0.0011" + as).err.find("less") == std::string::npos);
  BOOST_TEST(has((*this)("limits --grid 2x2 --spacing 0.0009" + as).err, "less than 1 mm"));

  BOOST_TEST((*this)("limits mm.json --scale 0.001").status == 2);
  for (const std::string bad : {"0", "-1", "nan", "inf"})
    BOOST_TEST((*this)("limits m.obj --scale " + bad).status == 2, bad);
  file("twice.json", "{\"geometry\": {\"mesh\": \"mm.obj\", \"scale\": 1},\n\"scale\": 1}");
  BOOST_TEST(
      has((*this)("limits twice.json").err, "twice.json:2: 'scale' stands in 'geometry' and beside it"));
}

// 2.5 cm: a particle falls so far in 0.0714 s.
BOOST_AUTO_TEST_CASE(a_step_that_cannot_follow_the_motion_is_told) {
  const std::string run = "simulate --grid 4x4 --pin 0 --duration 0.1 --method implicit-euler --json --step ";
  const std::string below = "0.003448", above = "0.003571429";  // 29 and 28 steps; a twentieth is 0.0035696 s
  BOOST_TEST((*this)(run + below).err == "");
  BOOST_TEST(
      has((*this)(run + above).err,
          "exceeds a twentieth of the time in which a particle falls by its shortest edge (0.07139 s)"));
  // One mass: its period is 2π/10 s.
  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 100\n");
  const std::string mass = "simulate --stiffness k.mtx --method rk4 --json ";
  BOOST_TEST((*this)(mass + "--duration 0.3125 --step 0.03125").err == "");
  const Outcome long_step = (*this)(mass + "--duration 0.3225 --step 0.03225");
  BOOST_TEST(has(long_step.err, "a twentieth of the slowest period (0.6283 s)"), long_step.err);
  BOOST_TEST(has((*this)("limits --stiffness k.mtx --method rk4").err, "slowest period (0.6283 s): rk4"));
}

BOOST_AUTO_TEST_CASE(energy_out_of_nothing_is_told) {
  file("mm.obj", strip(100));
  const std::string hung = "simulate --grid 6x6 --pin first-row --duration 1 --method rk4";
  const Json honest = (*this)(hung + " --json").json()["energy"];
  BOOST_TEST(honest["gained"].get<double>() <=
             1e-6 * std::abs(honest["final"].get<double>() - honest["initial"].get<double>()));
  const std::string run = "simulate mm.obj --pin 0 --duration 20 --method symplectic-euler --step 5";
  const Outcome told = (*this)(run);
  const Json gain = (*this)(run + " --json").json()["energy"];
  BOOST_TEST(gain["gained"].get<double>() > 0);
  BOOST_TEST(gain["gained"] == gain["final"].get<double>() - gain["initial"].get<double>());
  BOOST_TEST(has(told.out, "J beyond what gravity can give"), told.out);
  BOOST_TEST(!has((*this)(hung).out, "beyond"));
}

BOOST_AUTO_TEST_CASE(options_without_use_are_told) {
  const std::string run = "simulate --grid 4x4 --pin first-row --duration 0.01 --quiet --json --method ";
  const auto told = [&](const std::string& rest, const std::string& option) {
    return has((*this)(run + rest).err, "note: " + option + " has no use here: ");
  };
  for (const std::string option :
       {"--relinearize 0.02", "--hessian projected", "--solver direct", "--cg-tolerance 1e-3"}) {
    BOOST_TEST(told("rk4 " + option, option.substr(0, option.find(' '))), option);
    BOOST_TEST(told("rk4 " + option.substr(0, option.find(' ')) + '=' + option.substr(option.find(' ') + 1),
                    option.substr(0, option.find(' '))));
  }
  BOOST_TEST(!told("linearized-rk4 --relinearize 0.02", "--relinearize"));
  BOOST_TEST(!told("linearized-rk4 --hessian projected", "--hessian"));
  BOOST_TEST(!told("implicit-euler --solver direct --hessian projected", "--solver"));
  BOOST_TEST(!told("implicit-euler --cg-tolerance 1e-3", "--cg-tolerance"));
  BOOST_TEST(told("implicit-euler --solver direct --cg-tolerance 1e-3", "--cg-tolerance"));
  BOOST_TEST(told("rk4 --step 1e-4 --safety 2", "--safety"));
  BOOST_TEST(!told("rk4 --safety 2", "--safety"));
  BOOST_TEST(told("rk4 --frames 3", "--frames"));
  BOOST_TEST(!told("rk4 --frames 3 --output out", "--frames"));
  BOOST_TEST(
      has((*this)("limits --grid 4x4 --method rk4 --max-step 1").err, "note: --max-step has no use here"));
  BOOST_TEST((*this)("limits --grid 4x4 --max-step 1").err == "");
  BOOST_TEST(
      has((*this)("limits --grid 4x4 --diagonals alternating").err, "note: diagonals: have no use here"));
}

BOOST_AUTO_TEST_CASE(a_word_that_is_nearly_right_is_recognized) {
  const auto asks = [&](const std::string& command, const std::string& meant) {
    const Outcome outcome = (*this)(command);
    BOOST_TEST(outcome.status == 2, command);
    BOOST_TEST(has(outcome.err, "(did you mean '" + meant + "'?)"), command << ": " << outcome.err);
    BOOST_TEST(springstab::test::lines(outcome.err) == 1);
  };
  asks("limits --grid 4x4 --method RK4", "rk4");
  asks("simulate --grid 4x4 --duration 1 --method symplectic_euler", "symplectic-euler");
  asks("region implicit-eular", "implicit-euler");
  asks("limts --grid 4x4", "limits");
  asks("Simulate --grid 4x4", "simulate");
  asks("limits --grid 4x4 --methd rk4", "--method");
  asks("simulate --grid 4x4 --duraton 1 --method rk4", "--duration");
  asks("limits --gird=4x4", "--grid");
  asks("limits --grid 4x4 --jsno", "--json");
  asks("limits --grid 4x4 --material Soft", "soft");
  asks("limits --grid 4x4 --material baraf-witkin", "baraff-witkin");
  asks("simulate --grid 4x4 --duration 1 --method rk4 --damping desinged", "designed");
  asks("limits --grid 4x4 --diagonals alternate", "alternating");
  file("scene.json", R"({"geometry": {"grid": [3, 3], "diagonals": "Uniform"}})");
  asks("limits scene.json", "uniform");
  for (const std::string far : {"limits --grid 4x4 --method xyz", "qqqqqq --grid 4x4", "limits --qqqqqq"}) {
    const Outcome outcome = (*this)(far);
    BOOST_TEST(outcome.status == 2);
    BOOST_TEST(!has(outcome.err, "did you mean"), outcome.err);
  }
}

BOOST_AUTO_TEST_CASE(what_an_interrupted_run_kept_is_not_lost_unasked) {
  const std::string run =
      "simulate --grid 4x4 --pin 0 --method rk4 --step 1e-4 --duration 0.01 --output out ";
  fs::create_directories(folder() / "out");
  for (const std::string kept : {"simulate.checkpoint", "divergence.journal"}) {
    file("out/" + kept, "what was kept");
    const std::string command = kept[0] == 's' ? run : "divergence --quick --output out ";
    const Outcome asked = (*this)(command);
    BOOST_TEST(asked.status == 2);
    BOOST_TEST(asked.out == "");
    BOOST_TEST(has(asked.err, "out/" + kept +
                                  ": holds an interrupted run, expected --resume to go on with it or "
                                  "--overwrite to start anew"),
               asked.err);
    BOOST_TEST(content_of(folder() / "out" / kept) == "what was kept");
    BOOST_TEST((*this)(command + "--resume --overwrite").status == 2);
  }
  BOOST_TEST((*this)(run + "--resume").status == 2);  // that is no checkpoint
  const Outcome anew = (*this)(run + "--overwrite");
  BOOST_TEST(anew.status == 0, anew.err);
  BOOST_TEST(!fs::exists(folder() / "out" / "simulate.checkpoint"));
  BOOST_TEST((*this)(run).status == 0);  // a run that has ended is none
}

BOOST_AUTO_TEST_CASE(the_last_steps_of_a_run_that_diverges_are_kept_if_wanted) {
  const std::string run =
      "simulate --grid 8x8 --pin corners --method symplectic-euler --duration 1 --step 0.01 "
      "--json --output ";
  const Outcome plain = (*this)(run + "plain"), kept = (*this)(run + "kept --keep-diverged");
  BOOST_TEST(plain.status == 4);
  BOOST_TEST(kept.status == 4);
  const Json report = kept.json();
  BOOST_TEST(!plain.json().contains("diverged_frames"));
  // Every frame is a step: the last good one is the one before the divergence.
  BOOST_TEST(close(report["diverged_at"], report["frames"].get<double>() * report["step"].get<double>()));
  BOOST_TEST(report["diverged_frames"] == report["frames"]);
  file("fast.json",
       R"({"geometry": {"grid": [6, 6]}, "pins": "first-row", "initial": {"stretch": [1.1, 1, 1.1]}})");
  const std::string fast =
      "simulate fast.json --method symplectic-euler --duration 1 --step 0.0025 --json --output ";
  const Json few = (*this)(fast + "few --frames 2").json(),
             all = (*this)(fast + "all --frames 2 --keep-diverged").json();
  const long steps = std::lround(all["diverged_at"].get<double>() / all["step"].get<double>()) - 1;
  BOOST_TEST(few["frames"] == 1);
  BOOST_TEST(all["frames"] == steps + 1);  // from the start on
  BOOST_TEST(all["diverged_frames"] == all["frames"]);
  BOOST_TEST((*this)(fast.substr(0, fast.find(" --output")) + " --keep-diverged").status == 2);

  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 100\n");
  const Json matrix = (*this)(
                          "simulate --stiffness k.mtx --method symplectic-euler --step 0.25 --duration 100 "
                          "--frames 1 --keep-diverged --json --output m")
                          .json();
  const std::string rows = content_of(folder() / "m" / "trajectory.csv");
  BOOST_TEST(springstab::test::lines(rows) == 1 + matrix["frames"].get<long>());
  BOOST_TEST(matrix["diverged_frames"].get<long>() >= 4);
  // The explosion is there: h²k = 6.25, and the eigenvalue of symplectic Euler's matrix with trace 2 - 6.25.
  std::vector<double> x;
  std::istringstream in(rows);
  for (std::string row; std::getline(in, row);)
    x.push_back(std::atof(row.substr(row.rfind(',') + 1).c_str()));
  BOOST_TEST(close(x.back() / x[x.size() - 2], -(4.25 + std::sqrt(4.25 * 4.25 - 4)) / 2, 0.01));
}

BOOST_AUTO_TEST_CASE(progress_is_shown_on_a_terminal_and_erased_before_the_result,
                     *boost::unit_test::label("slow")) {
  const std::string limits = on_terminal(folder(), {"limits", "--grid", "300x300", "--pin", "first-row"});
  BOOST_TEST(has(limits, "\r\033[Klimits: "));
  BOOST_TEST(left_on(limits).starts_with("269100 unknowns"), left_on(limits).substr(0, 80));
  const std::string run = on_terminal(folder(), {"simulate", "--grid", "32x32", "--pin", "first-row",
                                                 "--method", "symplectic-euler", "--duration", "30"});
  BOOST_TEST(has(run, "\rsimulating ["));
  BOOST_TEST(left_on(run).starts_with("symplectic-euler, "), left_on(run).substr(0, 80));
  BOOST_TEST(!has((*this)("limits --grid 300x300 --pin first-row").err, "limits:"));
}

// √k0 [1/s] of 16 x 16 particles of 1.25e-4 kg, 2.5 cm apart: with one direction of
// diagonals, and of the net of another program whose diagonals alternate.
BOOST_AUTO_TEST_CASE(diagonals_alternate_as_elsewhere) {
  const auto root = [&](const std::string& beside, const std::string& in) {
    file("scene.json", R"({"geometry": {"grid": [16, 16])" + in + R"(}, "pins": "first-row", "material":
      {"model": "baraff-witkin", "particle_mass": 1.25e-4, "stretch": 1000, "shear": 100})" +
                           beside + "}");
    return std::sqrt((*this)("limits scene.json --method rk4 --json").json()["k0"]["value"].get<double>());
  };
  BOOST_TEST(std::abs(root("", "") - 6163) < 0.5);
  BOOST_TEST(std::abs(root(R"(, "diagonals": "uniform")", "") - 6163) < 0.5);
  BOOST_TEST(std::abs(root(R"(, "diagonals": "alternating")", "") - 5903) < 1);  // without its fraction
  BOOST_TEST(std::abs(root("", R"(, "diagonals": "alternating")") - 5903) < 1);  // without its fraction
  const std::string grid = "limits --grid 5x4 --material baraff-witkin --json --diagonals ";
  BOOST_TEST((*this)(grid + "uniform").json()["k0"]["value"] !=
             (*this)(grid + "alternating").json()["k0"]["value"]);
  file("strip.obj", strip(0.1));
  BOOST_TEST((*this)("limits strip.obj --diagonals uniform").status == 2);
  file("mesh.json", "{\"geometry\": {\"mesh\": \"strip.obj\"},\n\"diagonals\": \"uniform\"}");
  BOOST_TEST(has((*this)("limits mesh.json").err, "mesh.json:2: 'diagonals' stands with 'mesh'"));
}

BOOST_AUTO_TEST_SUITE_END()
