// The command as people and programs use it: run as a process, judged by its exit status, stdout and files.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "analysis/proofs/sparse_cholesky.h"
#include "tests/command.h"
#include "tests/places.h"

BOOST_FIXTURE_TEST_SUITE(command, springstab::test::Command)

namespace fs = std::filesystem;
using Json = nlohmann::json;
using springstab::test::Command;
using springstab::test::content_of;
using springstab::test::lines;
using springstab::test::Outcome;

namespace {

// Name -> entry of a list of methods.
Json by_name(const Json& list, const std::string& name) {
  for (const Json& entry : list)
    if (entry.at("name") == name) return entry;
  BOOST_FAIL("no method " + name);
  return {};
}

bool close(const Json& value, double expected, double tolerance = 1e-9) {
  return value.is_number() && std::abs(value.get<double>() - expected) <= tolerance * std::abs(expected);
}

const char* square =
    "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\n"
    "f 1 2 3 4\n";

}  // namespace

BOOST_AUTO_TEST_CASE(methods_are_listed_with_their_constants) {
  const Outcome run = (*this)("methods --json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const Json list = run.json().at("methods");
  const Json rk4 = by_name(list, "rk4"), implicit = by_name(list, "implicit-euler");
  BOOST_TEST(close(rk4["y_max"], 8.7623104291285, 1e-10));
  BOOST_TEST(close(rk4["x_at_y_max"], 0.8254052495503, 1e-10));
  BOOST_TEST(rk4["y_max_attained"] == true);
  BOOST_TEST(close(rk4["real_interval"], 2.785293563405, 1e-10));
  BOOST_TEST(close(rk4["imaginary_interval"], 2 * std::sqrt(2.0), 1e-10));
  BOOST_TEST(rk4["force_evaluations"] == 4);
  BOOST_TEST(rk4["order"] == 4);
  BOOST_TEST(rk4["implicit"] == false);
  BOOST_TEST(implicit["implicit"] == true);
  BOOST_TEST(implicit["y_max"] == "inf");
  BOOST_TEST(implicit["x_at_y_max"].is_null());
  BOOST_TEST(implicit["real_interval"] == "inf");
  BOOST_TEST(by_name(list, "explicit-euler")["imaginary_interval"] == 0.0);
  BOOST_TEST(by_name(list, "symplectic-euler")["y_max_attained"] == false);
}

BOOST_AUTO_TEST_CASE(global_options_stand_before_or_after_the_subcommand) {
  const Outcome before = (*this)("--json --seed 3 --threads 2 --quiet limits --grid 4x5 --pin first-row");
  const Outcome after = (*this)("limits --grid 4x5 --pin first-row --quiet --threads 2 --seed 3 --json");
  BOOST_TEST(before.status == 0);
  BOOST_TEST(before.out == after.out);
  BOOST_TEST(after.json()["degrees_of_freedom"] == 3 * 15);
}

BOOST_AUTO_TEST_CASE(a_region_has_its_cells_and_exact_area_in_any_window) {
  const Outcome run = (*this)(
      "region explicit-euler --x 0:2 --y -1:3 --nx 40 --ny 50 --raster raster.csv --boundary edge.csv "
      "--json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const Json report = run.json();
  BOOST_TEST(report["cells"] == 2000);
  BOOST_TEST(close(report["area"], 2, 1e-10));  // Y < X, 0 < X < 2
  BOOST_TEST(report["y_max"].get<double>() > 3.999999999);
  std::ifstream raster(folder() / "raster.csv");
  std::string header, row;
  std::getline(raster, header);
  BOOST_TEST(header == "x,y,spectral_radius");
  long rows = 0, stable = 0;
  while (std::getline(raster, row)) {
    double x, y, rho;
    BOOST_REQUIRE_EQUAL(std::sscanf(row.c_str(), "%lf,%lf,%lf", &x, &y, &rho), 3);
    ++rows;
    stable += rho < 1 - 1e-9;
    if (rho < 1 - 1e-9) BOOST_TEST((0 < y && y < x && y > 2 * x - 4));
  }
  BOOST_TEST(rows == 2000);
  BOOST_TEST(report["stable_cells"] == stable);
  BOOST_TEST(fs::file_size(folder() / "edge.csv") > 100u);
}

BOOST_AUTO_TEST_CASE(undamped_limits_follow_from_k0) {
  const Json report = (*this)("limits --grid 6x7 --pin corners --json").json();
  const double k0 = report["k0"]["value"];
  BOOST_TEST(report["k0"]["upper_bound"].get<double>() >= k0);
  BOOST_TEST(report["damping"]["kind"] == "none");
  const Json& list = report["methods"];
  BOOST_TEST(close(by_name(list, "rk4")["h_max"], std::sqrt(8 / k0)));
  BOOST_TEST(close(by_name(list, "rk4")["designed"]["h_max"], std::sqrt(8.7623104291285 / k0)));
  BOOST_TEST(close(by_name(list, "symplectic-euler")["h_max"], 2 / std::sqrt(k0)));
  BOOST_TEST(close(by_name(list, "symplectic-euler")["recommended_step"], 2 / std::sqrt(1.5 * k0)));
  // At Y = 4/1.5: the conserved form v² + Yx² + Yxv has the eigenvalues 1 ± √Y/2 in the norm of the energy.
  const double half = std::sqrt(4 / 1.5) / 2;
  BOOST_TEST(std::abs(by_name(list, "symplectic-euler")["transient_growth"].get<double>() /
                          std::sqrt((1 + half) / (1 - half)) -
                      1) < 1e-3);
  for (const char* method : {"explicit-euler", "rk2"}) {
    const Json none = by_name(list, method);
    BOOST_TEST(none["status"] == "none");
    BOOST_TEST(none["h_max"].is_null());
    BOOST_TEST(none["recommended_step"].is_null());
  }
  const Json implicit = by_name(list, "implicit-euler");
  BOOST_TEST(implicit["status"] == "unlimited");
  BOOST_TEST(implicit["h_max"] == "inf");
  BOOST_TEST(implicit["recommended_step"] == 0.01);
  for (const Json& entry : list)
    if (entry["h_max"].is_number())
      BOOST_TEST(entry["h_certified"].get<double>() <= entry["h_max"].get<double>());
}

BOOST_AUTO_TEST_CASE(no_answer_is_status_3_and_prints_what_is_known) {
  const Outcome limits = (*this)("limits --grid 4x4 --method rk2 --json");
  BOOST_TEST(limits.status == 3);
  BOOST_TEST(limits.json()["k0"]["value"].is_number());
  const Outcome run = (*this)("simulate --grid 4x4 --method rk2 --duration 0.1 --json --output frames");
  BOOST_TEST(run.status == 3);
  BOOST_TEST(run.json()["step"].is_null());
  BOOST_TEST(!fs::exists(folder() / "frames"));
  BOOST_TEST((*this)("limits --grid 4x4 --certify").status == 3);
  BOOST_TEST((*this)("limits --grid 4x4 --certify --method rk4").status == 0);
}

BOOST_AUTO_TEST_CASE(springs_with_their_own_damping_have_an_exact_limit_under_symplectic_euler) {
  const fs::path scene = file("scene.json", R"({"geometry": {"grid": [4, 4]}, "pins": "first-row",
    "material": {"damping": {"structural": 1e-4, "shear": 1e-4, "bending": 1e-4}}})");
  const Json report = (*this)("limits scene.json --json").json();
  BOOST_TEST(report["damping"]["kind"] == "general");
  const Json certified = by_name(report["methods"], "rk4");
  BOOST_TEST(certified["status"] == "limited");
  BOOST_TEST(certified["h_max_source"] == "estimate");
  BOOST_TEST(certified["h_certified"].get<double>() <= certified["h_max"].get<double>());
  BOOST_TEST(certified["recommended_step"].get<double>() < certified["h_max"].get<double>());
  BOOST_TEST(by_name(report["methods"], "implicit-euler")["status"] == "unlimited");
  BOOST_TEST(certified["transient_growth"].is_null());  // not known for this damping
  const Json exact = by_name(report["methods"], "symplectic-euler");
  BOOST_TEST(exact["status"] == "limited");
  BOOST_TEST(exact["h_max_source"] == "exact");
  BOOST_TEST(exact["h_certified"].get<double>() <= exact["h_max"].get<double>());
  BOOST_TEST(exact["h_certified"].get<double>() > (1 - 1e-6) * exact["h_max"].get<double>());
  BOOST_TEST(exact["recommended_step"].get<double>() < exact["h_max"].get<double>());
  BOOST_TEST(exact["h_every_pose"].get<double>() <= exact["h_max"].get<double>() * (1 + 1e-9));
  const Json run = (*this)("simulate scene.json --method symplectic-euler --duration 0.1 --json").json();
  BOOST_TEST(run["status"] == "done");
  BOOST_TEST(run["step"].get<double>() <= exact["recommended_step"].get<double>() * (1 + 1e-9));
  BOOST_TEST((*this)("simulate scene.json --method rk4 --duration 0.1").status == 0);
  BOOST_TEST((*this)("simulate scene.json --method rk4 --duration 0.1 --step 5e-4").status == 0);
}

BOOST_AUTO_TEST_CASE(a_run_ends_at_the_duration_and_leaves_its_frames) {
  file("cloth.obj", square);
  const Outcome run = (*this)(
      "simulate cloth.obj --pin 0,1 --method symplectic-euler --duration 0.5 --step 0.003 --max-step 1 "
      "--output frames --frames 4 --json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const Json report = run.json();
  BOOST_TEST(report["steps"] == 167);
  BOOST_TEST(close(report["step"], 0.5 / 167, 1e-15));
  BOOST_TEST(report["diverged"] == false);
  BOOST_TEST(report["diverged_at"].is_null());
  BOOST_TEST(report["counts"]["force_evaluations"] == 167);
  BOOST_TEST(report["counts"]["hessian_assemblies"] == 0);
  BOOST_TEST(report["frames"] == 5);
  for (int i = 0; i < 5; ++i)
    BOOST_TEST(fs::exists(folder() / "frames" / ("frame_0000" + std::to_string(i) + ".obj")));
  BOOST_TEST(std::distance(fs::directory_iterator(folder() / "frames"), fs::directory_iterator()) ==
             5 + 1);  // and energy.csv

  std::ifstream last(folder() / "frames" / "frame_00004.obj");
  std::string word;
  double x, y, z;
  for (int vertex = 0; vertex < 4; ++vertex) BOOST_REQUIRE((last >> word >> x >> y >> z) && word == "v");
  const Json position = report["last_particle"]["position"];
  BOOST_TEST((close(position[0], x, 1e-15) && close(position[1], y, 1e-15) && close(position[2], z, 1e-15)));
  BOOST_TEST((last >> word && word == "f"));
}

// Two squares that share an edge, in two groups of one object, with a material and a seam in their texture.
const std::string labelled_strip =
    "mtllib fabrics.mtl\no Strip\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 0 0 2\nv 1 0 2\n"
    "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvt 0.5 0.25\nvn 0 1 0\n"
    "g collar seam\nusemtl silk\ns 1\nf 1/1/1 2/2/1 4/4/1 3/3/1\ng hem\nf 3/5/1 -3/4/1 6/2/1 5/1/1\n";

BOOST_AUTO_TEST_CASE(frames_keep_what_the_obj_file_says_of_its_faces) {
  fs::create_directory(folder() / "meshes");
  file("meshes/strip.obj", labelled_strip);
  const Outcome run = (*this)(
      "simulate meshes/strip.obj --pin group:collar --method rk4 --duration 0.1 --output frames --frames 1");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const std::string frame = content_of(folder() / "frames" / "frame_00000.obj");
  BOOST_TEST(frame ==
             "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 0 0 2\nv 1 0 2\n"
             "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvt 0.5 0.25\n"
             "mtllib ../meshes/fabrics.mtl\no Strip\ng collar seam\nusemtl silk\ns 1\n"
             "f 1/1 2/2 4/4 3/3\ng hem\nf 3/5 4/4 6/2 5/1\n");
}

BOOST_AUTO_TEST_CASE(pins_are_chosen_by_group_object_or_box) {
  file("strip.obj", labelled_strip);
  const auto unknowns = [&](const std::string& input) {
    return (*this)("limits " + input + " --json").json()["degrees_of_freedom"].get<int>();
  };
  const std::pair<std::string, int> chosen[] = {{"group:collar", 6},        {"group:seam", 6},
                                                {"group:hem", 6},           {"'box:0:0,:,:'", 9},
                                                {"box:0.5:2,-1:1,1:3", 12}, {"'box::,:,1:1'", 12}};
  for (const auto& [pin, left] : chosen)
    BOOST_TEST_CONTEXT(pin) BOOST_TEST(unknowns("strip.obj --pin " + pin) == left);
  BOOST_TEST(unknowns("strip.obj --scale 0.5 --pin box::,:,0.5:0.5") == 12);
  BOOST_TEST(unknowns("--grid 5x4 --pin box:0.025:0.05,:,:0.025") == 3 * (20 - 4));
  file("pins.json", R"({"geometry": {"mesh": "strip.obj"}, "pins": "group:hem"})");
  BOOST_TEST(unknowns("pins.json") == 6);

  const std::pair<std::string, std::string> refused[] = {
      {"strip.obj --pin group:colar",
       "--pin: no face is of the group 'colar', expected 'collar seam' or 'hem'"},
      {"strip.obj --pin object:Stripe",
       "--pin: no face is of the object 'Stripe', expected 'Strip' (did you mean 'Strip'?)"},
      {"strip.obj --pin box:5:6,:,:",
       "--pin: no particle rests in the box 5:6,-inf:inf,-inf:inf, expected one that meets the scene's "
       "0:1,0:0,0:2 m"},
      {"strip.obj --pin corners", "expected particle numbers, a group, an object or a box"},
      {"--grid 5x4 --pin group:collar", "--pin: a grid has no groups and objects"},
      {"strip.obj --pin box:1,2,3", "--pin: the box '1,2,3' is not one, expected three times lower:upper"}};
  for (const auto& [input, message] : refused) {
    const Outcome outcome = (*this)("limits " + input);
    BOOST_TEST_CONTEXT(outcome.err) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(outcome.err.find(message) != std::string::npos);
    }
  }
}

BOOST_AUTO_TEST_CASE(energies_of_a_scene_stand_beside_its_frames) {
  const Outcome run = (*this)(
      "simulate --grid 5x4 --pin first-row --method symplectic-euler --duration 0.2 --output out --frames 20 "
      "--json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  std::istringstream rows(content_of(folder() / "out" / "energy.csv"));
  std::string names, row;
  std::getline(rows, names);
  BOOST_TEST(names == "t,kinetic_energy,potential_energy");
  std::vector<std::array<double, 3>> all;
  while (std::getline(rows, row)) {
    std::array<double, 3> r{};
    BOOST_REQUIRE(std::sscanf(row.c_str(), "%lf,%lf,%lf", &r[0], &r[1], &r[2]) == 3);
    all.push_back(r);
  }
  BOOST_REQUIRE(all.size() == 21u);
  const Json energy = run.json()["energy"];
  BOOST_TEST(close(energy["initial"], all.front()[1] + all.front()[2], 1e-12));
  BOOST_TEST(close(energy["final"], all.back()[1] + all.back()[2], 1e-12));
  BOOST_TEST(close(all[20][0], 0.2, 1e-12));
  BOOST_TEST(all[10][1] > 0);
}

// Whether the energy is below zero at the start is for the seed to say, whether motion grows is not.
BOOST_AUTO_TEST_CASE(what_grows_by_itself_does_not_diverge) {
  file("soft.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 100\n2 2 -1\n");
  bool below = false, above = false;
  for (int seed = 1; seed <= 8; ++seed)
    for (const char* method : {"rk4 --step 0.001", "symplectic-euler --step 0.001", "rk4"})
      BOOST_TEST_CONTEXT(method << ", seed " << seed) {
        const Outcome run =
            (*this)(std::string("simulate --stiffness soft.mtx --json --duration 10 --method ") + method +
                    " --seed " + std::to_string(seed));
        BOOST_TEST(run.status == 0);
        const auto report = run.json();
        BOOST_TEST(report.at("grows") == true);
        const double start = report.at("energy").at("initial"), end = report.at("energy").at("final");
        if (std::string(method) == "rk4 --step 0.001") BOOST_TEST(std::abs(end - start) < 1e-3);
        (start < 0 ? below : above) = true;
      }
  BOOST_TEST((below && above));
  const Outcome text = (*this)("simulate --stiffness soft.mtx --duration 10 --method rk4");
  BOOST_TEST(text.out.find("unstable: its motion grows by itself") != std::string::npos);
  const Outcome calm = (*this)("simulate --grid 3x3 --pin first-row --duration 0.1 --method rk4 --json");
  BOOST_TEST(calm.json().at("grows") == false);
  // A step beyond the limit of the stiff mode is too long all the same.
  for (int seed = 1; seed <= 8; ++seed)
    BOOST_TEST((*this)("simulate --stiffness soft.mtx --duration 30 --method rk4 --step 0.3 --seed " +
                       std::to_string(seed))
                   .status == 4);
}

// K = diag(2, -1): the motion grows as e^t, and no method's run of it is a divergence: at a step that is
// given, at the recommended one where there is one, at one at which a fast motion is not resolved.
BOOST_AUTO_TEST_CASE(growth_is_followed_by_every_method) {
  file("saddle.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 2\n2 2 -1\n");
  const Outcome limits = (*this)("limits --stiffness saddle.mtx --json");
  BOOST_TEST(limits.json().at("growth_rate").get<double>() == 1, boost::test_tools::tolerance(1e-14));
  BOOST_TEST((*this)("limits --stiffness saddle.mtx").out.find("the fastest at 1 1/s") != std::string::npos);
  int recommended = 0;
  const auto report = limits.json();  // outlives the loop
  for (const auto& method : report.at("methods"))
    for (const std::string step : {"", " --step 0.01", " --step 0.25"})
      BOOST_TEST_CONTEXT(method.at("name") << step) {
        if (step.empty() && method.at("status") == "none") continue;
        recommended += step.empty();
        const Outcome run = (*this)("simulate --stiffness saddle.mtx --json --duration 40 --method " +
                                    method.at("name").get<std::string>() + step);
        BOOST_TEST(run.status == 0);
        BOOST_TEST(run.json().at("grows") == true);
        BOOST_TEST(run.json().at("diverged") == false);
      }
  BOOST_TEST(recommended >= 4);
}

BOOST_AUTO_TEST_CASE(what_a_run_cannot_use_is_refused) {
  const auto refused = [&](const std::string& options) {
    const Outcome run =
        (*this)("simulate --grid 3x3 --pin 0 --duration 0.1 --method implicit-euler " + options);
    BOOST_TEST(run.status == 2);
    return run.err;
  };
  for (const char* tolerance : {"1", "2", "0", "nan"})
    BOOST_TEST(refused(std::string("--cg-tolerance ") + tolerance).find("less than 1") != std::string::npos);
  BOOST_TEST(refused("--frames 2147483647").find("expected 1 to 10000000") != std::string::npos);
  BOOST_TEST(refused("--step 3e-4 --max-step 1e-4").find("expected at most --max-step") != std::string::npos);
  BOOST_TEST(refused("--seed -1").find("--seed") != std::string::npos);
  BOOST_TEST(refused("--max-step 1e-300").find("steps of 1e-300 s") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(what_leaves_double_precision_is_refused) {
  const auto matrix = [](const std::string& a, const std::string& b) {
    return "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 " + a + "\n2 2 " + a + "\n2 1 " + b +
           "\n";
  };
  const auto limits = [&](const std::string& options) {
    return (*this)("limits --stiffness K.mtx " + options);
  };
  for (const auto& [k, d] :
       {std::pair("e200", "e100"), {"e160", "e80"}, {"e-170", "e-85"}, {"e-200", "e-100"}}) {
    file("K.mtx", matrix(std::string("2") + k, std::string("-1") + k));
    file("D.mtx", matrix(std::string("2") + d, std::string("1") + d));
    const Outcome refused = limits("--damping-matrix D.mtx");
    BOOST_TEST(refused.status == 2);
    BOOST_TEST(refused.err.find("take a unit of time nearer to it") != std::string::npos);
  }
  file("K.mtx", matrix("2e-300", "-1e-300"));
  file("M.mtx", matrix("2e300", "0"));
  BOOST_TEST(limits("--mass M.mtx").status == 2);
  file("K.mtx", matrix("-2", "0"));
  BOOST_TEST(limits("").out.find("nan") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(regions_of_impossible_windows_are_refused) {
  for (const char* options :
       {"--x 0:1e80 --y 0:1", "--x 0:1e-12", "--y 0:1e300", "--simulate -3", "--simulate 100000",
        "--simulate 3 --steps 0", "--cells c.csv", "--raster a.csv --boundary a.csv"})
    BOOST_TEST_CONTEXT(options) {
      const Outcome refused = (*this)(std::string("region rk4 ") + options);
      BOOST_TEST(refused.status == 2);
      BOOST_TEST(lines(refused.err) == 1);
      BOOST_TEST(!std::filesystem::exists(folder() / "a.csv"));
    }
  BOOST_TEST((*this)("region rk4 --x -1e30:1e30 --y -1e30:1e30 --nx 3 --ny 3").status == 0);
}

BOOST_AUTO_TEST_CASE(frames_of_an_earlier_run_are_told) {
  const std::string run = "simulate --grid 3x3 --pin 0 --duration 0.1 --method rk4 --output out --frames ";
  BOOST_TEST((*this)(run + "9").err == "");
  BOOST_TEST((*this)(run + "9").err == "");
  BOOST_TEST((*this)(run + "4").err.starts_with("springstab: note: out/frame_00005.obj: "));
}

BOOST_AUTO_TEST_CASE(divergence_is_status_4_with_its_time) {
  const Outcome run = (*this)(
      "simulate --grid 8x8 --pin corners --method symplectic-euler --duration 1 --step 0.01 "
      "--output frames --json");
  BOOST_TEST(run.status == 4);
  const Json report = run.json();
  BOOST_TEST(report["diverged"] == true);
  const double steps_to_it = report["diverged_at"].get<double>() / 0.01;
  BOOST_TEST(close(steps_to_it, std::round(steps_to_it)));
  BOOST_TEST((steps_to_it > report["steps"] && steps_to_it <= report["steps"].get<double>() + 16));
  for (const fs::directory_entry& frame : fs::directory_iterator(folder() / "frames")) {
    const std::string text = content_of(frame.path());
    BOOST_TEST(text.find("nan") == std::string::npos);
    BOOST_TEST(text.find("inf") == std::string::npos);
  }
}

// A net pulled to three times its size and let go gets stiffer than it was: at the first step alone it gains
// energy, or explodes. The same watch serves linearized and other methods.
BOOST_AUTO_TEST_CASE(a_run_that_gets_too_stiff_is_saved_by_shorter_steps) {
  file("scene.json",
       R"({"geometry": {"grid": [8, 8]}, "pins": "first-row", "damping": {"d0": 1, "alpha": "designed"},
           "initial": {"stretch": [3, 1, 3]}})");
  for (const std::string method : {"explicit-euler", "linearized-explicit-euler"}) {
    BOOST_TEST_CONTEXT(method) {
      const std::string run = "simulate scene.json --duration 1 --json --method " + method;
      const Json saved = (*this)(run).json();
      BOOST_TEST(saved["counts"]["rollbacks"] > 0);
      BOOST_TEST(saved["diverged"] == false);
      const Outcome fixed = (*this)(run + " --step " + saved["step"].dump());
      const auto energy = [](const Json& report) { return report["energy"]["final"].get<double>(); };
      BOOST_TEST((fixed.status == 4 || energy(fixed.json()) > 1.5 * energy(saved)));
    }
  }
}

// Damping αK of compressed springs gives energy (K is indefinite there): the motion itself explodes, and no
// step helps. The run gives up and keeps what it had.
BOOST_AUTO_TEST_CASE(a_motion_that_explodes_ends_with_status_4_and_its_last_good_frame) {
  file("scene.json",
       R"({"geometry": {"grid": [6, 6]}, "pins": "first-row", "damping": {"alpha": 0.01},
           "initial": {"stretch": [0.5, 1, 0.5]}})");
  for (const std::string method : {"explicit-euler", "rk4", "linearized-explicit-euler"}) {
    BOOST_TEST_CONTEXT(method) {
      const Outcome run =
          (*this)("simulate scene.json --method " + method + " --duration 1 --output " + method + " --json");
      BOOST_TEST(run.status == 4);
      const Json report = run.json();
      BOOST_TEST(report["diverged"] == true);
      BOOST_TEST((report["diverged_at"] > 0.0 && report["diverged_at"] < 1.0));
      BOOST_TEST(report["counts"]["rollbacks"] > 0);
      BOOST_TEST(report["frames"] > 0);
      long frames = 0;
      for (const fs::directory_entry& frame : fs::directory_iterator(folder() / method)) {
        const std::string text = content_of(frame.path());
        BOOST_TEST(text.find("nan") == std::string::npos);
        BOOST_TEST(text.find("inf") == std::string::npos);
        ++frames;
      }
      BOOST_TEST(report["frames"] == frames - 1);  // and their energies, without those of what was undone
      BOOST_TEST(lines(content_of(folder() / method / "energy.csv")) == frames);
    }
  }
}

// Every part that the scene has is there with its counts, every other is said to be left out, and a method
// that linearizes nothing has no matrix.
BOOST_AUTO_TEST_CASE(an_explanation_lists_what_a_scene_has_and_what_it_lacks) {
  const auto explained = [&](const std::string& scene, const std::string& options) {
    file("scene.json", scene);
    const Json report = (*this)("simulate scene.json --duration 0.02 --json --explain " + options).json();
    BOOST_TEST(report["diverged"] == false);
    return report["explanation"];
  };
  const auto part = [](const Json& explanation, const std::string& name, const std::string& work) {
    for (const Json& p : explanation["parts"])
      if (p["name"].get<std::string>().find(name) != std::string::npos && p["work"] == work) return p;
    return Json();
  };
  const auto lacks = [](const Json& explanation, const std::string& what) {
    return explanation["left_out"].dump().find(what) != std::string::npos;
  };

  const Json springs =
      explained(R"({"geometry": {"grid": [4, 3]}, "material": {"bending": 0}})", "--method rk4 --step 1e-4");
  BOOST_TEST(springs["particles"] == 12);
  BOOST_TEST(springs["parts"].size() == 1u);
  BOOST_TEST(part(springs, "springs", "force")["elements"] == 17 + 12);  // edges and diagonals
  BOOST_TEST(part(springs, "springs", "force")["times_per_step"] == 4.0);
  BOOST_TEST(lacks(springs, "bending springs"));
  BOOST_TEST(lacks(springs, "no matrix D"));
  BOOST_TEST(lacks(springs, "neither assembled nor stored"));
  BOOST_TEST(!lacks(springs, "shear springs"));

  const Json cloth =
      explained(R"({"geometry": {"grid": [4, 3]}, "pins": "first-row", "damping": {"alpha": 1e-3},
                    "material": {"model": "baraff-witkin", "damping": {"stretch": 0.1}}})",
                "--method implicit-euler");
  BOOST_TEST(cloth["pinned"] == 3);
  BOOST_TEST(part(cloth, "triangles that resist", "Hessian")["times_per_step"] == 1.0);
  BOOST_TEST(part(cloth, "hinges that resist", "Hessian")["elements"] > 0);
  BOOST_TEST(part(cloth, "triangles that damp", "damping matrix")["times_per_step"] == 1.0);
  BOOST_TEST(part(cloth, "blocks of K", "product")["times_per_step"] >= 1.0);
  BOOST_TEST(part(cloth, "conjugate gradients", "iteration")["times_per_step"] >= 1.0);
  BOOST_TEST(part(cloth, "blocks of K", "product")["bytes"] >= 76 * 9);
  BOOST_TEST(part(cloth, "blocks of D", "product")["elements"] > 0);
  BOOST_TEST(cloth["left_out"].empty());
  BOOST_TEST((*this)("simulate --stiffness k.mtx --method rk4 --duration 1 --explain").status == 2);
}

// What is written with a coefficient of 0 costs and changes as much as what is not written: nothing.
BOOST_AUTO_TEST_CASE(an_unused_feature_changes_no_count_and_no_digit) {
  const auto run = [&](const std::string& material, const std::string& rest) {
    file("scene.json",
         R"({"geometry": {"grid": [8, 8]}, "pins": "corners", "material": {)" + material + "}" + rest + "}");
    Json report =
        (*this)("simulate scene.json --method implicit-euler --duration 0.1 --json --explain").json();
    for (const char* clock : {"cpu_seconds", "explanation"}) report.erase(clock);
    return report;
  };
  const Json plain = run(R"("bending": 0)", "");
  BOOST_TEST(plain["counts"]["cg_iterations"] > 0);
  BOOST_TEST(plain == run(R"("bending": 0, "damping": {"structural": 0, "shear": 0, "bending": 0})",
                          R"(, "damping": {"d0": 0, "alpha": 0})"));
  const std::string cloth = R"("model": "baraff-witkin", "bending": 0)";
  BOOST_TEST(run(cloth, "") == run(cloth + R"(, "damping": {"stretch": 0, "shear": 0, "bending": 0})", ""));
  BOOST_TEST(plain["counts"] != run(R"("bending": 20)", "")["counts"]);
}

// The net of the speed table (docs/speed.md), 64 x 64 and smaller, after half a second of implicit Euler. The
// numbers are what conjugate gradients to 1e-13 and the factorization agree on; to 1e-10 they are 1e-11 m
// off.
BOOST_AUTO_TEST_CASE(the_hanging_net_drapes_as_it_always_did, *boost::unit_test::label("slow")) {
  std::ifstream shipped(springstab::test::source_folder() + "/experiments/scenes/hanging_net_64.json");
  Json scene = Json::parse(shipped);
  BOOST_TEST(scene["geometry"]["grid"] == Json({64, 64}));
  const struct {
    int size;
    double y;  // of the last particle [m]
    std::vector<std::string> solvers;
  } drapes[] = {{16, -0.3113285838783, {"cg", "direct"}},
                {32, -0.7733992700915, {"cg", "direct"}},
                {64, -1.0598566997297, {"cg"}}};
  for (const auto& drape : drapes)
    for (const std::string& solver : drape.solvers) BOOST_TEST_CONTEXT(drape.size << ", " << solver) {
        scene["geometry"]["grid"] = {drape.size, drape.size};
        file("net.json", scene.dump());
        const Json run = (*this)(
                             "simulate net.json --method implicit-euler --step 0.01 --duration 0.5 --json "
                             "--cg-tolerance 1e-10 --solver " +
                             solver)
                             .json();
        BOOST_TEST(run["status"] == "done");
        BOOST_TEST(run["steps"] == 50);
        BOOST_TEST(run["solver"] == solver);
        BOOST_TEST(run["cg_tolerance"].is_null() == (solver == "direct"));
        BOOST_TEST((run["counts"]["cg_iterations"] > 0) == (solver == "cg"));
        BOOST_TEST(close(run["last_particle"]["position"][1], drape.y, 1e-9));
      }
}

BOOST_AUTO_TEST_CASE(designed_damping_makes_explicit_euler_run) {
  const Outcome run = (*this)(
      "simulate --grid 6x6 --pin first-row --method explicit-euler --duration 0.2 --damping designed --json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const Json report = run.json();
  BOOST_TEST(close(report["damping"]["alpha"], report["step"], 1e-9));  // d0 = 0: alpha = h

  file("scene.json",
       R"({"geometry": {"grid": [6, 6]}, "pins": "first-row", "damping": {"d0": 2, "alpha": "designed"}})");
  const Json limits = (*this)("limits scene.json --json").json();
  const Json euler = by_name(limits["methods"], "explicit-euler");
  BOOST_TEST(limits["damping"]["alpha"] == "designed");
  BOOST_TEST(euler["h_max"] == euler["designed"]["h_max"]);
  const double h = euler["designed"]["h_max"];
  BOOST_TEST(close(euler["designed"]["alpha"], h * (4 - 2 * h) / 4, 1e-9));  // paper Eq. 31
}

BOOST_AUTO_TEST_CASE(matrices_give_limits_and_a_trajectory_from_the_seed) {
  file("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n");
  const Json report = (*this)("limits --stiffness k.mtx --json").json();
  BOOST_TEST(close(report["k0"]["value"], 3, 1e-12));
  const std::string run = "simulate --stiffness k.mtx --method rk4 --duration 2 --output ";
  BOOST_TEST((*this)(run + "a --seed 1").status == 0);
  BOOST_TEST((*this)(run + "b --seed 1").status == 0);
  BOOST_TEST((*this)(run + "c --seed 2").status == 0);
  const auto content = [&](const char* name) { return content_of(folder() / name / "trajectory.csv"); };
  BOOST_TEST(content("a") == content("b"));
  BOOST_TEST(content("a") != content("c"));
  double x1, x2;
  std::istringstream rows(content("a"));
  std::string row;
  std::getline(rows, row);
  BOOST_TEST(row == "t,kinetic_energy,potential_energy,x1,x2");
  std::getline(rows, row);
  BOOST_REQUIRE_EQUAL(std::sscanf(row.c_str(), "%*f,%*f,%*f,%lf,%lf", &x1, &x2), 2);
  BOOST_TEST(close(Json(x1 * x1 + x2 * x2), 1, 1e-14));  // unit M-norm
}

// No step of an indefinite structure is certified, and it is said why.
BOOST_AUTO_TEST_CASE(indefinite_matrices_have_no_certificate_but_a_reason) {
  file("saddle.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 -1\n");
  file("bowl.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 4\n");
  const std::pair<std::string, std::string> cases[] = {
      {"--stiffness saddle.mtx", "K is indefinite"},
      {"--stiffness saddle.mtx --damping-matrix bowl.mtx", "K is indefinite"},
      {"--stiffness bowl.mtx --damping-matrix saddle.mtx", "D is indefinite"}};
  for (const auto& [matrices, reason] : cases) BOOST_TEST_CONTEXT(matrices) {
      const Outcome shown = (*this)("limits " + matrices);
      BOOST_TEST(shown.status == 0);
      BOOST_TEST(shown.out.find("not certified, " + reason) != std::string::npos);
      const Json report = (*this)("limits " + matrices + " --json").json();
      for (const Json& limits : report["methods"]) {
        BOOST_TEST(limits["h_certified"].is_null());
        BOOST_TEST(limits["h_certified_source"].is_null());
        BOOST_TEST(limits["reason"] == (limits["status"] == "none" ? "no positive step is stable" : reason));
      }
      BOOST_TEST((*this)("limits " + matrices + " --certify").status == 3);
    }
}

// Each number that k0 is known by says what it is.
BOOST_AUTO_TEST_CASE(the_bounds_on_k0_are_labelled) {
  const Json small = (*this)("limits --grid 4x5 --pin first-row --json").json()["k0"];
  const Json large = (*this)("limits --grid 9x9 --pin first-row --json").json()["k0"];
  BOOST_TEST(small["value_kind"] == "eigenvalue");
  BOOST_TEST(large["value_kind"] == "Ritz value");
  for (const Json& k0 : {small, large}) {
    BOOST_TEST(k0["bound"] == "inertia");
    const double value = k0["value"], inertia = k0["bounds"]["inertia"],
                 gershgorin = k0["bounds"]["gershgorin"];
    BOOST_TEST(k0["upper_bound"] == inertia);
    BOOST_TEST(value < inertia);
    BOOST_TEST(inertia < value * (1 + 1e-8));
    BOOST_TEST(inertia < gershgorin);
    BOOST_TEST(k0["residual"].get<double>() < 1e-8 * value);
  }
}

BOOST_AUTO_TEST_CASE(bad_input_is_one_line_and_status_2_and_leaves_nothing) {
  file("cloth.obj", square);
  file("broken.obj", "v 0 0 0\nv 1 0 zero\nf 1 2 1\n");
  file("line.obj", "v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n");
  file("heavy.json", R"({"geometry": {"mesh": "cloth.obj"}, "material": {"area_density": -1}})");
  file("typo.json", "{\"geometry\": {\"grid\": [3, 3]},\n \"gravty\": [0, 0, 0]}");
  file("skew.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 1\n2 1 -1\n");
  file("saddle.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 -1\n");
  file("one.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 1\n");
  const std::string simulate = "simulate cloth.obj --method rk4 --duration 1 --output out ";
  const std::pair<std::string, std::string> cases[] = {
      {"", "subcommand"},
      {"limits", "nothing was given"},
      {"limits cloth.obj --grid 3x3", "more than one"},
      {"limits absent.obj", "absent.obj"},
      {"limits broken.obj", "broken.obj:2"},
      {"limits line.obj", "line.obj:4"},
      {"limits heavy.json", "heavy.json:1"},
      {"limits typo.json", "gravity"},
      {"limits typo.json", "typo.json:2"},
      {"limits heavy.json --pin 0", "scene file itself"},
      {"limits --grid 3by3", "ROWSxCOLUMNS"},
      {"limits --grid 2x2 --pin 0-3", "all particles are pinned"},
      {"limits --grid 2x2 --pin 7", "does not exist"},
      {"limits cloth.obj --pin first-row", "grid"},
      {"limits --grid 2x2 --material sof", "soft"},
      {"limits --grid 2x2 --safety 0.9", "safety"},
      {"limits --grid 2x2 --safety nan", "safety"},
      {"limits --grid 2x2 --method rk3", "rk4"},
      {"limits --grid 2x2 --spacing -1", "--grid"},
      {"simulate --stiffness skew.mtx --method rk4 --duration 1", "not symmetric"},
      {"simulate --stiffness saddle.mtx --method rk4 --duration 1 --damping designed", "designed"},
      {"limits --stiffness saddle.mtx --mass one.mtx", "mass matrix is 1 x 1"},
      {"limits --mass one.mtx cloth.obj", "--stiffness"},
      {"region rk4 --x 2:1", "--x"},
      {"region rk4 --nx 0", "--nx"},
      {"region rk4 --raster no/such/folder.csv", "no/such/folder.csv"},
      {simulate + "--step 0", "--step"},
      {simulate + "--step nan", "--step"},
      {simulate + "--frames 0", "--frames"},
      {simulate + "--format dae", "dae"},
      {simulate + "--damping some", "some"},
      {"simulate --stiffness one.mtx --method rk4 --duration 1 --damping designed", "designed"},
      {"simulate cloth.obj --method rk4 --duration -1", "--duration"},
      {"figures 9", "9"},
      {"figures --plots . 1", "region.gp"},
      {"complexity --plots . --output there", "complexity.gp"},
  };
  const auto files = [&] {
    return std::distance(fs::directory_iterator(folder()), fs::directory_iterator());
  };
  const auto before = files();
  for (const auto& [arguments, word] : cases) {
    const Outcome run = (*this)(arguments);
    BOOST_TEST_CONTEXT(arguments << " -> " << run.err) {
      BOOST_TEST(run.status == 2);
      BOOST_TEST(run.out.empty());
      BOOST_TEST(lines(run.err) == 1);
      BOOST_TEST(run.err.find(word) != std::string::npos);
      BOOST_TEST(files() == before);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_solid_of_tetrahedra_is_a_scene_like_any_other) {
  const std::string tets =
      "*VERTICES\n6 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 9 9 9\n"
      "*ELEMENTS\nTET\n2 4 0\n1 1 2 4 3\n2 2 3 4 5\n";
  file("solid.veg", tets);
  file("cloth.obj", square);
  file("solid.json", R"({"geometry": {"mesh": "solid.veg"}, "pins": "0-2",
                         "material": {"model": "tetrahedra", "density": 500, "edge": 100, "altitude": 50,
                                      "damping": {"edge": 0.1, "altitude": 0.2}}})");
  file("cloth.json", R"({"geometry": {"mesh": "solid.veg"}, "material": {"model": "baraff-witkin"}})");
  file("solid of cloth.json", R"({"geometry": {"mesh": "cloth.obj"}, "material": {"model": "tetrahedra"}})");

  const Outcome limits = (*this)("limits solid.veg --json");
  BOOST_TEST(limits.status == 0);
  BOOST_TEST(lines(limits.err) == 2);  // so soft a solid of that size takes steps too long to see it fall
  BOOST_TEST(limits.err.find("by its shortest edge") != limits.err.npos);
  BOOST_TEST(limits.err.find("dropped 1 unreferenced vertex, turned 1 left-handed tetrahedron") !=
             limits.err.npos);
  const Json report = limits.json();
  BOOST_TEST(report["degrees_of_freedom"] == 15);
  BOOST_TEST(report["mesh"]["left_handed_tetrahedra"] == 1);
  BOOST_TEST(report["mesh"]["overlapped_faces"] == 0);
  const double stiff = (*this)("limits solid.veg --material stiff --json").json()["k0"]["value"];
  BOOST_TEST(stiff == 100 * report["k0"]["value"].get<double>(), boost::test_tools::tolerance(1e-9));

  // ½ g t² = 0.049 m, to a step more or less (0.0049 m): the particle hangs on springs that are hardly
  // strained yet
  for (const std::string method : {"symplectic-euler", "implicit-euler", "linearized-rk4"}) {
    const Outcome run = (*this)("simulate solid.json --method " + method +
                                " --duration 0.1 --step 0.01 --output out --frames 2 --json");
    BOOST_TEST(run.status == 0);
    const double fall = 1 - run.json()["last_particle"]["position"][1].get<double>();
    BOOST_TEST(std::abs(fall - 0.049) < 0.006);
  }
  BOOST_TEST((*this)("limits solid.json --json").json()["damping"]["kind"] == "general");
  const std::string frame = content_of(folder() / "out" / "frame_00002.obj");
  BOOST_TEST(lines(frame) == 6 + 6);  // the file's vertices, and the surface
  BOOST_TEST(frame.find("v 9 9 9\n") != std::string::npos);

  const std::pair<std::string, std::string> refused[] = {
      {"limits cloth.json", "cloth.json:1: 'model' is 'baraff-witkin', expected 'tetrahedra'"},
      {"limits 'solid of cloth.json'", "expected 'springs' or 'baraff-witkin'"},
      {"limits solid.veg --material baraff-witkin", "--material"},
      {"limits solid.veg --pin 6", "does not exist"},
      {"limits solid.dae", "solid.dae: is of no known kind, expected a suffix: .json"},
  };
  for (const auto& [arguments, word] : refused) {
    const Outcome run = (*this)(arguments);
    BOOST_TEST_CONTEXT(arguments << " -> " << run.err) {
      BOOST_TEST(run.status == 2);
      BOOST_TEST(run.err.find(word) != std::string::npos);
    }
  }
}

BOOST_AUTO_TEST_CASE(complexity_tells_tables_and_every_run, *boost::unit_test::label("slow")) {
  const Outcome run = (*this)("complexity --quick --json");
  BOOST_REQUIRE_EQUAL(run.status, 0);
  const Json report = run.json();
  BOOST_TEST(report["all_finished"] == true);
  BOOST_TEST(report["rollbacks"] == 0);
  BOOST_TEST(report["studies"].size() == 4);
  for (const Json& study : report["studies"])
    for (const Json& series : study["series"]) {
      BOOST_TEST(series["exponent"].is_number());
      for (const Json& point : series["points"]) BOOST_TEST(point["cpu_seconds"].size() == study["rounds"]);
    }
  BOOST_TEST(report["tables"].size() == 4);
  for (const Json& table : report["tables"])
    for (const Json& row : table) BOOST_TEST(row.size() == table[0].size());
}

BOOST_AUTO_TEST_CASE(help_has_examples_and_version_is_a_number) {
  BOOST_TEST((*this)("--help").status == 0);
  for (const char* subcommand :
       {"methods", "region", "limits", "simulate", "complexity", "work-precision", "figures"}) {
    const Outcome help = (*this)(std::string(subcommand) + " --help");
    BOOST_TEST(help.status == 0);
    BOOST_TEST(help.out.find("example") != std::string::npos);
  }
  int major, minor, patch;
  const std::string version = (*this)("--version").out;
  BOOST_TEST(std::sscanf(version.c_str(), "%d.%d.%d", &major, &minor, &patch) == 3);
  const std::string cholmod = springstab::has_cholmod() ? "with CHOLMOD" : "without CHOLMOD";
  BOOST_TEST(version.find("\n" + cholmod) != std::string::npos);
  const std::string run = "simulate --grid 3x3 --method rk4 --step 1e-3 --duration 0.01 --explain --json";
  const Json built = (*this)(run).json().at("explanation").at("built");
  BOOST_TEST(built.get<std::string>().starts_with(cholmod));
}

BOOST_AUTO_TEST_CASE(work_precision_reports_errors_costs_and_what_the_reference_is_worth) {
  const std::string input = "work-precision --grid 4x4 --pin first-row --quiet --json --no-libraries ";
  const Outcome outcome = (*this)(input + "--duration 0.02 --time-limit 0.005 --repetitions 2");
  BOOST_REQUIRE(outcome.status == 0);
  const Json report = outcome.json();
  const double own = report["reference"]["error"]["trajectory"];
  BOOST_TEST(own > 0);
  BOOST_TEST(own < 1e-8);
  long compared = 0;
  for (const Json& contestant : report["contestants"])
    for (const Json& run : contestant["runs"])
      if (run["compared"]) {
        ++compared;
        BOOST_TEST(run["errors"]["trajectory"].get<double>() >= 100 * own);
        BOOST_TEST(run["cpu_seconds"].size() == 2u);
        BOOST_TEST(run["equivalents"].get<long>() > 0);
      }
  BOOST_TEST(compared > 10);
  BOOST_TEST((*this)(input + "--duration 0").status == 2);
  BOOST_TEST((*this)(input + "--duration 1 --repetitions 0").status == 2);
  const fs::path scene =
      file("scene.json", R"({"geometry": {"grid": [4, 4]}, "damping": {"alpha": "designed"}})");
  BOOST_TEST((*this)("work-precision '" + scene.string() + "' --duration 1").status == 2);
}

// k = 1 and d = 10: the fast mode limits explicit Euler, and stiffening slows it down.
BOOST_AUTO_TEST_CASE(where_damping_dominates_there_is_a_margin_too) {
  const Command springstab;
  const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 ";
  springstab.file("K.mtx", head + "1\n");
  springstab.file("D.mtx", head + "10\n");
  const Outcome outcome = springstab("limits --stiffness K.mtx --damping-matrix D.mtx --json");
  const auto list = outcome.json()["methods"];
  const double slow = 5 - std::sqrt(24.0), fast = 5 + std::sqrt(24.0);  // rates of the two motions
  const auto euler = by_name(list, "explicit-euler");
  BOOST_TEST(close(euler["h_max"], 2 / fast));
  BOOST_TEST(slow * fast == 1, boost::test_tools::tolerance(1e-12));
  for (const auto& method : list) {
    if (method["status"] != "limited") continue;
    const double step = method["recommended_step"];
    BOOST_TEST(step <= method["h_max"].get<double>() / std::sqrt(1.5) * (1 + 1e-12), method["name"]);
    BOOST_TEST(step <= method["h_certified"].get<double>(), method["name"]);
  }
}

// A chain with a massless end: D = 0.2 M + 0.01 K damps the end by its stiffness alone.
BOOST_AUTO_TEST_CASE(rayleigh_damping_of_matrices_is_that_of_a_matrix) {
  const Command springstab;
  const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n3 3 ";
  springstab.file("K.mtx", head + "5\n1 1 2\n2 1 -1\n2 2 2\n3 2 -1\n3 3 1\n");
  springstab.file("M.mtx", head + "2\n1 1 1\n2 2 2\n");
  springstab.file("D.mtx", head + "5\n1 1 0.22\n2 1 -0.01\n2 2 0.42\n3 2 -0.01\n3 3 0.01\n");
  const Json given = springstab("limits --stiffness K.mtx --mass M.mtx --rayleigh 0.2,1e-2 --json").json();
  const Json same = springstab("limits --stiffness K.mtx --mass M.mtx --damping-matrix D.mtx --json").json();
  BOOST_TEST(given["condensed"] == 1);
  BOOST_TEST(close(given["condensed_rate"], 100));
  BOOST_TEST(given["damping"]["kind"] == "rayleigh");
  BOOST_TEST(close(given["damping"]["d0"], 0.2));
  for (const char* method : {"rk4", "explicit-euler", "symplectic-euler"})
    BOOST_TEST(close(by_name(given["methods"], method)["h_max"],
                     by_name(same["methods"], method)["h_max"].get<double>()));
  const Json twice =
      springstab("limits --stiffness K.mtx --mass M.mtx --damping-matrix D.mtx --rayleigh 0.2,0.01 --json")
          .json();
  BOOST_TEST(close(twice["damping"]["alpha"], 0.02));
  for (const std::string bad : {"0.2", "1,x", "-1,0", "1,-2", "1,2,3", ",", "nan,0", "0x1,0"}) {
    const Outcome refused = springstab("limits --stiffness K.mtx --rayleigh " + bad);
    BOOST_TEST(refused.status == 2);
    BOOST_TEST(refused.err.find("--rayleigh") != std::string::npos, refused.err);
  }
}

BOOST_AUTO_TEST_SUITE_END()
