// Runs that blew up, of this program and of others: method, factor, step and mode are found again from frames
// alone. Runs that are sound have nothing to find.
#include <Eigen/Eigenvalues>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "analysis/spectra/spectrum.h"
#include "experiments/diagnosis.h"
#include "solvers/io/input_error.h"
#include "solvers/io/npy.h"
#include "solvers/scene/spring_cloth.h"
#include "tests/command.h"
#include "tests/places.h"

BOOST_AUTO_TEST_SUITE(blow_up)

using namespace springstab;
using boost::test_tools::tolerance;
using springstab::test::Command;
using springstab::test::Outcome;
using Complex = std::complex<double>;

namespace {

// The largest eigenvalue of a step of h on the mode (k, d), with its imaginary part >= 0.
Complex factor_of(const Method& method, double h, double k, double d = 0) {
  Complex largest = 0;
  for (const Complex lambda : method.amplification(h * d, h * h * k).eigenvalues())
    if (std::abs(lambda) > std::abs(largest)) largest = lambda;
  return {largest.real(), std::abs(largest.imag())};
}

// Whether one takes the steps of the other on this mode.
bool same_steps(const Method& a, const Method& b, double h, double k) {
  return std::abs(factor_of(a, h, k) - factor_of(b, h, k)) < 1e-6;
}

struct Run {
  RunFrames frames;
  double h;
};

// Every state of a run until it is no more finite; positions to `digits` decimals where that is not 0.
Run run_of(Model& model, const Subject* scene, const Method& method, double h, int steps,
           State<Vector> state) {
  const auto stepper = method.stepper();
  std::vector<Vector> all;
  const auto keep = [&] {
    if (!scene) return all.push_back(state.x);
    Vector frame(3 * static_cast<Eigen::Index>(scene->vertices(state.x).size()));
    Eigen::Index i = 0;
    for (const Eigen::Vector3d& p : scene->vertices(state.x)) frame.segment<3>(3 * i++) = p;
    all.push_back(frame);
  };
  keep();
  stepper->start(model.system(), h, state);
  for (int n = 0; n < steps && stepper->step(model.system(), h, state) == StepStatus::done; ++n) keep();
  RunFrames frames{Eigen::MatrixXd(all[0].size(), static_cast<Eigen::Index>(all.size())), scene ? 3 : 1, {}};
  for (std::size_t n = 0; n < all.size(); ++n) frames.positions.col(static_cast<Eigen::Index>(n)) = all[n];
  return {std::move(frames), h};
}

std::unique_ptr<Subject> grid(const std::string& size, const std::string& material = "default",
                              const std::string& pin = "first-row") {
  InputOptions options;
  options.grid = size;
  options.material = material;
  options.pin = pin;
  return std::make_unique<Subject>(options);
}

double limit(Model& model, const Method& method) {
  StructureLimits answer(model.structure(model.initial_state()), {.certify = false});
  return answer.limits(method).h_max.value();
}

Diagnosis diagnosis_of(const Run& run, Model* model, const Subject* scene) {
  return diagnose(run.frames, {.h = run.h}, model, scene, "frames", built_in_methods());
}

void check_silent(const std::string& what, const RunFrames& frames, double h) {
  BOOST_TEST_CONTEXT(what) {
    const Diagnosis found = diagnose(frames, {.h = h}, nullptr, nullptr, "frames", {});
    BOOST_TEST(std::string(name(found.status)) == "no growth");
    BOOST_TEST(!found.growth.has_value());
    BOOST_TEST(found.used == frames.positions.cols());
  }
}

}  // namespace

// A scene falls, swings and blows up in one; its pose changes while it grows, and with it what grows.
BOOST_AUTO_TEST_CASE(runs_of_this_program_are_known_again) {
  const std::vector<std::pair<const char*, double>> cases{{"symplectic-euler", 1.03},
                                                          {"symplectic-euler", 1.15},
                                                          {"velocity-verlet", 1.1},
                                                          {"rk4", 1.04},
                                                          {"rk4", 1.15},
                                                          {"newmark:rule=central-difference", 1.05},
                                                          {"nystrom4", 1.05}};
  for (const auto& [method_name, ratio] : cases) BOOST_TEST_CONTEXT(method_name << " at " << ratio) {
      const Method method(method_name);
      const auto subject = grid("9x7");
      const double h = ratio * limit(*subject, method);
      const Run run = run_of(*subject, subject.get(), method, h, 400, subject->initial_state());
      const Diagnosis found = diagnosis_of(run, subject.get(), subject.get());
      BOOST_REQUIRE(std::string(name(found.status)) == "growing");
      BOOST_REQUIRE(found.fit());
      BOOST_TEST(same_steps(found.fit()->method, method, h, found.seen->stiffness),
                 found.fit()->method.name());
      BOOST_TEST(found.fit()->step_over_limit.value() == ratio, tolerance(0.04));
      const Complex factor = found.factor().value();
      const Complex expected = factor_of(method, h, found.seen->stiffness);
      BOOST_TEST(std::abs(factor - expected) < 0.05 * std::abs(expected));
      BOOST_TEST(found.seen->of_stiffest > 0.9);
      BOOST_TEST(found.seen->of_stiffest < 1.001);
      BOOST_TEST(found.vertices.size() == 10);
      for (const Eigen::Index v : found.vertices) BOOST_TEST((v >= 7 && v < 63));  // the first row is pinned
    }
}

// Of matrices all is exact: the factor is the method's own on the stiffest mode, and the pattern is that
// mode.
BOOST_AUTO_TEST_CASE(of_a_linear_run_factor_and_mode_are_exact) {
  const auto spring_chain = [](int n) {
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n), m = k;
    for (int i = 0; i <= n; ++i) {
      const double spring = 50 + 31 * (i * 5 % 7);
      if (i < n) k(i, i) += spring, m(i, i) = 1 + 0.2 * (i * 3 % 4);
      if (i > 0) k(i - 1, i - 1) += spring;
      if (i > 0 && i < n) k(i, i - 1) = k(i - 1, i) = -spring;
    }
    return Model(std::make_unique<MatrixSystem>(prepare(k.sparseView(), m.sparseView())));
  };
  const std::vector<std::pair<const char*, double>> cases{{"symplectic-euler", 2 * 1.05},
                                                          {"rk4", 2.95},
                                                          {"explicit-euler", 0.3},
                                                          {"rk2", 0.9},
                                                          {"newmark:beta=0,gamma=0.6", 1.95}};
  for (const auto& [method_name, frequency] : cases) BOOST_TEST_CONTEXT(method_name << " at " << frequency) {
      const Method method(method_name);
      Model model = spring_chain(9);
      StructureLimits answer(model.structure(model.initial_state()), {.certify = false});
      const double k0 = answer.k0().value, h = frequency / std::sqrt(k0);
      const Run run = run_of(model, nullptr, method, h, 900, model.initial_state());
      const Diagnosis found = diagnose(run.frames, {.h = h}, &model, nullptr, "frames", [&] {
        std::vector<Method> known = built_in_methods();
        known.push_back(method);
        return known;
      }());
      BOOST_REQUIRE(std::string(name(found.status)) == "growing");
      const Complex expected = factor_of(method, h, k0);
      BOOST_TEST(std::abs(found.factor().value() - expected) < 5e-3 * std::abs(expected));
      BOOST_TEST(found.seen->of_stiffest == 1, tolerance(0.02));
      BOOST_TEST(found.seen->overlap.value() > 0.98);
      BOOST_REQUIRE(found.fit());
      BOOST_TEST(same_steps(found.fit()->method, method, h, k0), found.fit()->method.name());
      BOOST_TEST((kind_of(*found.factor()) == std::string(expected.imag() == 0 ? "alternating" : "ringing")));
    }
}

// Integrators that are not this program's, in another language and in files of three kinds.
BOOST_FIXTURE_TEST_CASE(runs_of_other_programs_are_known_again, Command) {
  const std::string script = "python3 '" + springstab::test::source_folder() + "/tests/foreign_run.py' ";
  struct Case {
    const char *kind, *method;
    double ratio;  // to 2/√k0
    int every;
    const char* form;
  };
  const std::vector<Case> cases{
      {"net", "symplectic-euler", 1.04, 1, "obj"},   {"net", "symplectic-euler", 1.15, 1, "vtk"},
      {"net", "velocity-verlet", 1.1, 1, "obj"},     {"net", "rk4", 1.48, 1, "vtk"},
      {"chain", "symplectic-euler", 1.02, 1, "npy"}, {"chain", "symplectic-euler", 1.02, 3, "npy"},
      {"chain", "velocity-verlet", 1.3, 1, "npy"},   {"chain", "rk4", 1.5, 1, "npy"},
      {"chain", "explicit-euler", 0.2, 1, "npy"},    {"chain", "rk2", 0.6, 2, "npy"}};
  BOOST_REQUIRE((*this).shell(script + "chain rk4 1e-3 1 1 npy \"$PWD/none\"").status == 0);
  for (const Case& c : cases) BOOST_TEST_CONTEXT(c.kind << ' ' << c.method << " at " << c.ratio) {
      const bool net = std::string(c.kind) == "net";
      const std::string input = net ? " --grid 6x5 --pin first-row" : " --stiffness K.mtx --mass M.mtx";
      const double k0 =
          (*this)("limits --json --method symplectic-euler" + input).json()["k0"]["value"].get<double>();
      const double h = c.ratio * 2 / std::sqrt(k0);
      const std::string step = text("%.17g", h);
      std::filesystem::remove_all(folder() / "run");
      const Outcome ran = shell(script + c.kind + ' ' + c.method + ' ' + step + " 300 " +
                                std::to_string(c.every) + ' ' + c.form + " \"$PWD/run\"");
      BOOST_REQUIRE_MESSAGE(ran.status == 0, ran.err);
      const Outcome outcome =
          (*this)("diagnose run --json --step " + step + " --every " + std::to_string(c.every) + input);
      BOOST_REQUIRE_MESSAGE(outcome.status == 0, outcome.err);
      const auto json = outcome.json();
      BOOST_REQUIRE(json["status"] == "growing");
      BOOST_REQUIRE_MESSAGE(!json["fits"].is_null(), outcome.out);
      const double k = json["pattern"]["stiffness"].get<double>();
      const std::string fit = json["fits"]["method"].get<std::string>();
      BOOST_TEST(same_steps(fit, c.method, h, k), fit);
      const Complex factor(json["factor"][0].get<double>(), json["factor"][1].get<double>());
      // These let every mode grow, the stiffest little faster than the next: the pattern has both.
      const bool all_grow = std::string(c.method) == "explicit-euler" || std::string(c.method) == "rk2";
      const Complex expected = factor_of(c.method, h, net || all_grow ? k : k0);
      BOOST_TEST(std::abs(factor - expected) < (net        ? 0.06
                                                : all_grow ? 0.02
                                                           : 0.01) *
                                                   std::abs(expected),
                 factor);
      BOOST_TEST(json["pattern"]["of_stiffest"].get<double>() == 1, tolerance(all_grow ? 0.15 : 0.1));
      const double limit_ratio = std::string(c.method) == "rk4" ? c.ratio / std::sqrt(2) : c.ratio;
      if (all_grow)
        BOOST_TEST(json["fits"]["step_over_limit"].is_null());
      else
        BOOST_TEST(json["fits"]["step_over_limit"].get<double>() == limit_ratio,
                   tolerance(net ? 0.05 : 1e-6));
    }
}

BOOST_AUTO_TEST_CASE(sound_runs_are_silent) {
  for (const auto& [method_name, ratio] : std::vector<std::pair<const char*, double>>{
           {"symplectic-euler", 0.2}, {"symplectic-euler", 0.9}, {"rk4", 0.95}, {"velocity-verlet", 0.6}}) {
    const auto subject = grid("9x7");
    const double h = ratio * limit(*subject, method_name);
    const Run run = run_of(*subject, subject.get(), method_name, h, 800, subject->initial_state());
    check_silent(std::string("falling cloth, ") + method_name, run.frames, h);
  }
  const auto stiff = grid("8x8", "stiff");
  check_silent("implicit",
               run_of(*stiff, stiff.get(), "implicit-euler", 0.005, 300, stiff->initial_state()).frames,
               0.005);
  const auto free = grid("6x6", "default", "none");
  const double free_step = 0.9 * limit(*free, "symplectic-euler");
  check_silent("free fall",
               run_of(*free, free.get(), "symplectic-euler", free_step, 400, free->initial_state()).frames,
               free_step);

  // One oscillator, undamped and damped until rounding is all that is left of it; to six decimals, as text
  // has it; and rounding alone.
  for (const double d : {0.0, 8.0}) {
    Eigen::MatrixXd k(1, 1), damping(1, 1);
    k << 400, damping << d;
    Model mode(
        std::make_unique<MatrixSystem>(prepare(k.sparseView(), {}, SparseMatrix(damping.sparseView()))));
    Run run = run_of(mode, nullptr, "symplectic-euler", 0.08, 3000, mode.initial_state());
    check_silent("an oscillator", run.frames, run.h);
    run.frames.positions = (1e6 * run.frames.positions).array().round().matrix() / 1e6;
    check_silent("an oscillator to six decimals", run.frames, run.h);
  }
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  check_silent("rounding",
               {1 + 1e-15 * Eigen::MatrixXd::NullaryExpr(30, 500, [&] { return normal(engine); }).array(), 3},
               1e-3);
  check_silent("rest", {Eigen::MatrixXd::Constant(30, 100, 0.3), 3}, 1e-3);
  // Smooth motions from rest, as a script moves what is pinned.
  Eigen::MatrixXd script(6, 400);
  for (int n = 0; n < 400; ++n)
    for (int i = 0; i < 6; ++i) script(i, n) = std::pow(n / 400.0, i + 1);
  check_silent("powers of time", {script, 3}, 1e-3);
}

BOOST_AUTO_TEST_CASE(what_grows_with_one_sign_is_told_from_falling) {
  // An inverted pendulum beside a falling mass: e^{5t}, and t².
  Eigen::MatrixXd run(2, 400);
  for (int n = 0; n < 400; ++n) run.col(n) << 1e-9 * std::exp(0.05 * n), -4.905 * 1e-4 * n * n;
  const Diagnosis found = diagnose({run, 1}, {.h = 0.01}, nullptr, nullptr, "frames", {});
  BOOST_REQUIRE(std::string(name(found.status)) == "growing");
  BOOST_TEST(found.factor()->real() == std::exp(0.05), tolerance(1e-3));
  BOOST_TEST(found.factor()->imag() == 0);
  BOOST_TEST(found.vertices[0] == 0);
}

BOOST_AUTO_TEST_CASE(growth_begins_where_it_does) {
  // A swing that a step too long takes over at frame 120.
  Eigen::MatrixXd run(9, 200);
  for (int n = 0; n < 200; ++n)
    for (int i = 0; i < 9; ++i)
      run(i, n) =
          std::cos(0.05 * n + i) + (n < 120 ? 0 : 1e-6 * std::pow(-1.31, n - 120) * ((i * i) % 5 - 1.5));
  const Diagnosis found = diagnose({run, 3}, {.h = 0.01}, nullptr, nullptr, "frames", {});
  BOOST_REQUIRE(found.growth);
  BOOST_TEST(found.factor()->real() == -1.31, tolerance(1e-3));
  BOOST_TEST(found.growth->from >= 115);
  BOOST_TEST(found.growth->from <= 135);
}

BOOST_FIXTURE_TEST_CASE(what_is_no_run_gets_a_line, Command) {
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Outcome outcome = (*this)("diagnose " + arguments);
    BOOST_TEST_CONTEXT(arguments) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(outcome.out.empty());
      BOOST_TEST(outcome.err.find(words) != std::string::npos, outcome.err);
      BOOST_TEST(test::lines(outcome.err) == 1, outcome.err);
    }
  };
  const auto make = [&](const std::string& name, const std::vector<std::string>& files) {
    std::filesystem::create_directory(folder() / name);
    for (std::size_t i = 0; i < files.size(); ++i) file(name + "/f" + std::to_string(i) + ".obj", files[i]);
  };
  refused("none --step 1", "is not there");
  make("empty", {});
  refused("empty --step 1", "has no frames");
  make("one", {"v 0 0 0\n"});
  refused("one --step 1", "has one frame");
  make("counts", {"v 0 0 0\n", "v 0 0 0\nv 1 1 1\n"});
  refused("counts --step 1", "f1.obj: has 2 vertices, expected 1");
  make("nan", {"v nan 0 0\n", "v 0 0 0\n"});
  refused("nan --step 1", "no finite position");
  make("word", {"v 0 0 0\n", "v 0 x 0\n"});
  refused("word --step 1", "f1.obj:1:");
  make("two", {"v 0 0 0\n", "v 0 0 0\n"});
  refused("two --step 0", "--step");
  refused("two --step 1 --every 0", "--every");
  refused("two --step 1 --grid 4x4", "frames of 3 numbers, expected 48");
  file("two/a.vtk", "");
  refused("two --step 1", "2 kinds");
  file("text.npy", "no array at all, only words");
  refused("text.npy --step 1", "x93NUMPY");

  // A run that ends in NaN is used up to there; one that is at rest has nothing to say.
  make("ends", {"v 0 0 0\n", "v 0 0 0\n", "v 0 0 0\n", "v nan(ind) inf -1.#IND\n"});
  const Outcome ends = (*this)("diagnose ends --step 1 --json");
  BOOST_REQUIRE(ends.status == 0);
  BOOST_TEST(ends.json()["used"] == 3);
  BOOST_TEST(ends.json()["status"] == "too fast");
  make("rest", {"v 0 0 0\n", "v 0 0 0\n", "v 0 0 0\n"});
  const Outcome rest = (*this)("diagnose rest --step 1 --json");
  BOOST_REQUIRE(rest.status == 0);
  BOOST_TEST(rest.json()["status"] == "no growth");
  BOOST_TEST(rest.json()["factor"].is_null());
}

BOOST_AUTO_TEST_CASE(arrays_are_read_as_they_are) {
  const std::string head = "{'descr': '>f8', 'fortran_order': False, 'shape': (1, 2), }";
  const std::string start = std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(head.size() + 1) + '\0';
  const std::string numbers("\x3f\xf8\0\0\0\0\0\0\xc0\0\0\0\0\0\0\0", 16);  // 1.5 and -2
  const NpyArray array = parse_npy("a", start + head + '\n' + numbers);
  BOOST_TEST(array.shape == (std::vector<long long>{1, 2}), boost::test_tools::per_element());
  BOOST_TEST(array.values == (std::vector<double>{1.5, -2}), boost::test_tools::per_element());
  for (const std::string& wrong : {start + head + '\n' + numbers.substr(1), start + head.substr(1) + numbers,
                                   start, std::string("\x93NUMPY"), std::string()})
    BOOST_CHECK_THROW(parse_npy("a", wrong), InputError);
}

BOOST_AUTO_TEST_SUITE_END()
