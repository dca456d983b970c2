// Methods from files: published intervals, orders, and those that a built-in method equals; limits against
// dense eigenvalues; and what is said of bad files.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <complex>
#include <filesystem>
#include <random>
#include <string>

#include "analysis/limits/general_damping.h"
#include "analysis/method_of_coefficients.h"
#include "analysis/regions/amplification.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/rigid_motions.h"
#include "analysis/spectra/spectrum.h"
#include "experiments/inputs/method_file.h"
#include "solvers/scene/scene.h"
#include "tests/command.h"
#include "tests/instruments.h"
#include "tests/places.h"
#include "tests/random_nets.h"
#include "tests/refusals.h"

BOOST_AUTO_TEST_SUITE(method_files)

using namespace springstab;
using namespace springstab::test;
using boost::test_tools::tolerance;

namespace {

const std::string folder = source_folder() + "/experiments/methods/";

Method shipped(const std::string& file) { return read_method_file(folder + file + ".json"); }

/// A method of this kind and these further keys.
Method of(const std::string& kind, const std::string& keys) {
  return parse_method("mine.json", R"({"name": "mine", "kind": ")" + kind + "\", " + keys + "}");
}

std::vector<std::string> all_shipped() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

struct Twin {
  const char* built_in;
  Method from_file;
};

/// Built-in methods, and what the same is in a file.
std::vector<Twin> twins() {
  const std::string gamma = "0.29289321881345248", rest = "0.70710678118654752", w = "0.35355339059327376";
  return {
      {"explicit-euler", of("runge-kutta", R"("A": [[]], "b": [1])")},
      {"rk2", of("runge-kutta", R"("A": [[], ["1/2"]], "b": [0, 1])")},
      {"rk4", of("runge-kutta", R"("A": [[], ["1/2"], [0, "1/2"], [0, 0, 1]],
                                   "b": ["1/6", "1/3", "1/3", "1/6"], "c": [0, 0.5, 0.5, 1])")},
      {"implicit-euler", of("runge-kutta", R"("A": [[1]], "b": [1])")},
      {"trapezoidal", of("runge-kutta", R"("A": [[], [0.5, 0.5]], "b": [0.5, 0.5])")},
      {"sdirk2", of("runge-kutta", "\"A\": [[" + gamma + "], [" + rest + ", " + gamma + "]], \"b\": [" +
                                       rest + ", " + gamma + "]")},
      {"tr-bdf2", of("runge-kutta", "\"A\": [[], [" + gamma + ", " + gamma + "], [" + w + ", " + w + ", " +
                                        gamma + "]], \"b\": [" + w + ", " + w + ", " + gamma + "]")},
      {"symplectic-euler", of("partitioned", R"("position": {"A": [[1]], "b": [1]},
                                                "velocity": {"A": [[0]], "b": [1]})")},
      {"velocity-verlet", shipped("verlet_pair")},
      {"nystrom4", shipped("nystrom4_tableau")},
      {"implicit-euler", of("multistep", R"("form": "first-order", "alpha": [-1, 1], "beta": [0, 1])")},
      {"trapezoidal", of("multistep", R"("form": "first-order", "alpha": [-2, 2], "beta": [1, 1])")},
      {"bdf2", of("multistep", R"("form": "first-order", "alpha": ["1/3", "-4/3", 1],
                                  "beta": [0, 0, "2/3"])")},
  };
}

/// Further multistep methods, and their orders.
std::vector<std::pair<Method, int>> multistep_methods() {
  const auto first = [](const std::string& alpha, const std::string& beta) {
    return of("multistep", R"("form": "first-order", "alpha": [)" + alpha + R"(], "beta": [)" + beta + "]");
  };
  return {{first("0, 0, 0, -1, 1", R"("-9/24", "37/24", "-59/24", "55/24", 0)"), 4},
          {first("0, -1, 1", R"("-1/12", "8/12", "5/12")"), 3},
          {first("0, 0, -1, 1", R"("1/24", "-5/24", "19/24", "9/24")"), 4},
          {first(R"("3/25", "-16/25", "36/25", "-48/25", 1)", R"(0, 0, 0, 0, "12/25")"), 4},
          {first("-1, 0, 1", "0, 2, 0"), 2},
          {of("multistep", R"("form": "second-order", "alpha": [1, -2, 1], "beta": ["1/12", "10/12", "1/12"],
                              "velocity": {"x": [0, -1, 1], "a": ["-1/24", "1/4", "7/24"]})"),
           4}};
}

/// x'' = -∇U(x) - c(v) of two unknowns, with both Jacobians: nonlinear, and coupled through U alone.
class Coupled final : public System {
 public:
  Eigen::Index size() const override { return 2; }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    const double pull = std::sin(x[0] - x[1]);
    out.resize(2);
    out << -2 * x[0] - 0.4 * std::pow(x[0], 3) - pull, -x[1] + pull;
    for (Eigen::Index i = 0; i < 2; ++i) out[i] -= (0.2 + 0.1 * v[i] * v[i]) * v[i];
  }
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override {
    const double c = std::cos(x[0] - x[1]);
    const Eigen::Matrix2d k{{2 + 1.2 * x[0] * x[0] + c, -c}, {-c, 1 + c}};
    const Eigen::Matrix2d d = (0.2 + 0.3 * v.array().square()).matrix().asDiagonal();
    linear = std::make_shared<MatrixSystem>(
        prepare(SparseMatrix(k.sparseView()), {}, SparseMatrix(d.sparseView())));
  }
  double kinetic_energy(const Vector& v) override { return v.squaredNorm() / 2; }
  double potential_energy(const Vector&) override { return 0; }
};

State<Vector> run(const Method& method, long steps, double duration) {
  Coupled system;
  State<Vector> state{Vector(2), Vector(2)};
  state.x << 0.9, -0.5;
  state.v << 0.3, 1.1;
  const double h = duration / static_cast<double>(steps);
  const auto stepper = method.stepper();
  stepper->start(system, h, state);
  for (long i = 0; i < steps; ++i) BOOST_REQUIRE(stepper->step(system, h, state) == StepStatus::done);
  return state;
}

double distance(const State<Vector>& a, const State<Vector>& b) {
  return std::hypot((a.x - b.x).norm(), (a.v - b.v).norm());
}

double real_interval(const Method& method) { return StabilityRegion(method).constants().real_interval; }

}  // namespace

BOOST_AUTO_TEST_CASE(intervals_are_those_published) {
  for (const char* name : {"ssprk3", "bogacki_shampine3", "kutta3"}) {
    const StabilityRegion region(shipped(name));
    const RegionConstants& c = region.constants();
    BOOST_TEST(c.real_interval == 2.512745326618, tolerance(1e-12));
    BOOST_TEST(c.imaginary_interval == std::sqrt(3.0), tolerance(1e-12));
    BOOST_TEST(std::abs(c.y_max - 6.44156) < 5e-6);
    BOOST_TEST(std::abs(c.x_at_y_max - 2.1526) < 5e-5);
    for (const double beside : {2.1525, 2.1527})
      BOOST_TEST(region.stable_intervals({{{beside}}, {{0, 1}}}, 0, 100).back().upper < c.y_max);
  }
  const StabilityRegion embedded(shipped("bogacki_shampine2"));
  BOOST_TEST(embedded.constants().real_interval == 3.152346612, tolerance(1e-9));
  BOOST_TEST(embedded.constants().imaginary_interval == 2.246433045, tolerance(1e-9));
  BOOST_TEST(std::abs(real_interval(shipped("dormand_prince5")) - 3.3066) < 1e-4);
  BOOST_TEST(real_interval(shipped("adams_bashforth3")) == 6. / 11, tolerance(1e-10));
  BOOST_TEST(StabilityRegion(shipped("stormer")).constants().imaginary_interval == 2, tolerance(1e-9));
  for (const char* name : {"gauss2", "lobatto_iiic2", "crouzeix3"})
    BOOST_TEST(StabilityRegion(shipped(name)).constants().covers_quadrant, name);
  BOOST_TEST(!StabilityRegion(shipped("bdf3")).constants().covers_quadrant);  // A(86°)-stable
  BOOST_TEST(std::isinf(real_interval(shipped("bdf3"))));
}

// R(z) of the eigenvalues of the oscillator, from the tableau by its definition 1 + z b(1 - zA)⁻¹1.
BOOST_AUTO_TEST_CASE(a_step_has_the_stability_function_of_its_tableau) {
  const auto r = [](const Eigen::MatrixXd& a, const Eigen::VectorXd& b, std::complex<double> z) {
    const Eigen::MatrixXcd system = Eigen::MatrixXcd::Identity(a.rows(), a.rows()) - z * a;
    const Eigen::VectorXcd ones = Eigen::VectorXcd::Ones(a.rows());
    return 1.0 + z * b.cast<std::complex<double>>().dot(system.fullPivLu().solve(ones));
  };
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 30; ++trial) {  // of full tableaus of 1 to 4 stages, with Σb = 1
    const Eigen::Index s = 1 + trial % 4;
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(s, s, [&] { return uniform(random); });
    Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(s, [&] { return uniform(random); });
    b[0] += 1 - b.sum();
    const Method method = method_of({"random", "random"}, runge_kutta(a, b));
    for (int i = 0; i < 20; ++i) {
      const double x = 2 + 2 * uniform(random), y = 4 + 4 * uniform(random);
      const std::complex<double> root = std::sqrt(std::complex<double>(x * x / 4 - y));
      const std::complex<double> one = r(a, b, -x / 2 + root), two = r(a, b, -x / 2 - root);
      const Eigen::MatrixXd step = method.amplification(x, y);
      const double size = std::max({1.0, std::abs(one), std::abs(two)});
      BOOST_TEST(std::abs(step.trace() - one - two) < 1e-8 * size);
      BOOST_TEST(std::abs(step.determinant() - one * two) < 1e-8 * size * size);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_file_that_says_what_a_built_in_method_is_gives_the_same) {
  RandomNets random(32);
  const StructuralMatrices s = without_rigid_motions(matrices(random.net(true)));
  const StiffestMode k0 = stiffest_mode(s);
  GeneralDamping limits(s, k0, {.kind = DampingModel::Kind::general}, 1.5, true);
  std::uniform_real_distribution<double> uniform(0, 5);
  std::mt19937_64 engine(33);
  for (const Twin& twin : twins()) BOOST_TEST_CONTEXT(twin.built_in) {
      const Method known(twin.built_in), &mine = twin.from_file;
      BOOST_TEST(mine.info().order == known.info().order);
      BOOST_TEST(mine.info().implicit == known.info().implicit);
      BOOST_TEST(mine.size() == known.size());
      for (int i = 0; i < 50; ++i) {
        const double x = uniform(engine), y = uniform(engine);
        BOOST_TEST((mine.amplification(x, y) - known.amplification(x, y)).norm() <
                   1e-13 * (1 + known.amplification(x, y).norm()));
      }
      const StabilityRegion region(mine);
      const RegionConstants &a = region.constants(), &b = stability_region(known).constants();
      const auto alike = [](double p, double q) {
        return p == q || std::abs(p - q) <= 1e-9 * std::abs(q) || (std::isnan(p) && std::isnan(q));
      };
      BOOST_TEST((alike(a.y_max, b.y_max) && alike(a.real_interval, b.real_interval)));
      BOOST_TEST(alike(a.imaginary_interval, b.imaginary_interval));
      BOOST_TEST(a.covers_quadrant == b.covers_quadrant);
      BOOST_TEST((region.matrix_form() == stability_region(known).matrix_form()));
      BOOST_TEST(region.exact_condition().has_value() ==
                 stability_region(known).exact_condition().has_value());
      const MethodLimits of_mine = limits.limits(mine), of_known = limits.limits(known);
      BOOST_TEST((of_mine.status == of_known.status));
      BOOST_TEST(of_mine.h_max.has_value() == of_known.h_max.has_value());
      if (of_mine.h_max) BOOST_TEST(alike(*of_mine.h_max, *of_known.h_max));
      BOOST_TEST(of_mine.h_certified.has_value() == of_known.h_certified.has_value());
      if (of_mine.h_certified) BOOST_TEST(*of_mine.h_certified == *of_known.h_certified, tolerance(1e-6));
    }
}

// On linear systems, where a Newton step is exact from any start; and where they start alike on others, too.
BOOST_AUTO_TEST_CASE(the_same_states_are_simulated) {
  RandomNets random(34);
  const StructuralMatrices s = matrices(random.net(false));
  MatrixSystem system(s);
  const double h = 0.2 / std::sqrt(stiffest_mode(s).value);
  for (const Twin& twin : twins()) BOOST_TEST_CONTEXT(twin.built_in) {
      const auto end = [&](const Method& method) {
        State<Vector> state{Vector::LinSpaced(s.size(), -1, 2), Vector::Ones(s.size())};
        const auto stepper = method.stepper();
        stepper->start(system, h, state);
        for (int i = 0; i < 50; ++i) BOOST_REQUIRE(stepper->step(system, h, state) == StepStatus::done);
        return state;
      };
      const State<Vector> a = end(twin.from_file), b = end(twin.built_in);
      BOOST_TEST(distance(a, b) < 1e-11 * std::hypot(b.x.norm(), b.v.norm()));
      if (std::string(twin.built_in) == "implicit-euler") continue;  // its Newton step begins elsewhere
      BOOST_TEST(distance(run(twin.from_file, 100, 1), run(twin.built_in, 100, 1)) < 1e-12);
    }
}

// On nonlinear forces, with damping that depends on the velocity: the error falls by 2^p as h is halved.
BOOST_AUTO_TEST_CASE(orders_are_what_the_tableaus_say) {
  const Method exact = shipped("dormand_prince5");
  const State<Vector> end = run(exact, 8000, 1);
  std::vector<Method> methods;
  for (const std::string& name : all_shipped()) methods.push_back(shipped(name));
  for (const Twin& twin : twins()) methods.push_back(twin.from_file);
  for (const auto& [method, order] : multistep_methods()) methods.push_back(method);
  for (const Method& method : methods) BOOST_TEST_CONTEXT(method.info().title) {
      const int p = method.info().order;
      const long n = p >= 5 ? 10 : p >= 4 ? 20 : 80;
      const double coarse = distance(run(method, n, 1), end), fine = distance(run(method, 2 * n, 1), end);
      const double measured = std::log2(coarse / fine);
      BOOST_TEST_MESSAGE(method.info().title << ": order " << p << ", measured " << measured << ", error "
                                             << fine);
      BOOST_TEST((measured > p - 0.3 && measured < p + 0.4), measured);
      BOOST_TEST(fine > 1e-12);
    }
}

BOOST_AUTO_TEST_CASE(orders_are_found_from_the_coefficients) {
  for (const auto& [name, order] : {std::pair{"ssprk3", 3},
                                    {"kutta3", 3},
                                    {"bogacki_shampine3", 3},
                                    {"bogacki_shampine2", 2},
                                    {"dormand_prince5", 5},
                                    {"crouzeix3", 3},
                                    {"gauss2", 4},
                                    {"lobatto_iiic2", 2},
                                    {"verlet_pair", 1},
                                    {"nystrom4_tableau", 4},
                                    {"adams_bashforth3", 3},
                                    {"bdf3", 3},
                                    {"stormer", 2}})
    BOOST_TEST(shipped(name).info().order == order, name);
  for (const auto& [method, order] : multistep_methods()) BOOST_TEST(method.info().order == order);
}

// Certified is below the truth; fully implicit methods are stable where they say they are; what has neither a
// stability function nor scalar coefficients has a proof by Lyapunov or a reason.
BOOST_AUTO_TEST_CASE(limits_are_below_the_truth_of_dense_eigenvalues, *boost::unit_test::label("slow")) {
  RandomNets random(35);
  int certified = 0, unlimited = 0, reasons = 0;
  std::vector<Method> methods;
  for (const std::string& name : all_shipped()) methods.push_back(shipped(name));
  for (int trial = 0; trial < 6; ++trial) {
    const StructuralMatrices s = without_rigid_motions(matrices(random.net(trial % 2 == 0)));
    const StiffestMode k0 = stiffest_mode(s);
    GeneralDamping limits(s, k0, {.kind = DampingModel::Kind::general}, 1.5, true);
    for (const Method& method : methods) BOOST_TEST_CONTEXT(method.name()) {
        MatrixSystem system(s);
        const auto growth = [&](double h) {
          const LinearOperator step = transition_operator(system, method, h);
          Eigen::MatrixXd a(step.size, step.size);
          Vector column;
          for (Eigen::Index j = 0; j < step.size; ++j) {
            step.apply(Vector::Unit(step.size, j), column);
            a.col(j) = column;
          }
          return largest_modulus(a);
        };
        const MethodLimits l = limits.limits(method);
        if (l.status == LimitStatus::unlimited) {
          for (const double part : {0.1, 1.0, 10.0, 100.0})
            BOOST_TEST(growth(part / std::sqrt(k0.value)) < 1 + 1e-7);
          unlimited += 1;
        } else if (l.h_certified) {
          for (const double part : {0.3, 0.7, 0.9999}) BOOST_TEST(growth(part * *l.h_certified) < 1 + 1e-7);
          certified += 1;
        } else {
          BOOST_TEST(!l.unproved.empty());
          reasons += 1;
        }
      }
  }
  BOOST_TEST_MESSAGE(certified << " certified, " << unlimited << " unlimited, " << reasons
                               << " with a reason");
  BOOST_TEST((certified >= 20 && unlimited >= 15));
}

BOOST_AUTO_TEST_CASE(simulated_cells_agree_with_the_region_outside_the_band) {
  std::mt19937_64 random(36);
  std::uniform_real_distribution<double> of_x(-1, 7), of_y(-1, 14);
  constexpr long steps = 1000;
  constexpr double threshold = 1e6;
  for (const std::string& name : all_shipped()) {
    const Method method = shipped(name);
    std::vector<double> x, y, rho(times(4000, 200));
    std::vector<CellFate> fates(rho.size());
    for (std::size_t i = 0; i < rho.size(); ++i) x.push_back(of_x(random)), y.push_back(of_y(random));
    spectral_radius(method, x, y, rho);
    simulate_cells(method, x, y, steps, threshold, fates);
    long outside = 0, diverged = 0;
    for (std::size_t i = 0; i < rho.size(); ++i) {
      const bool agrees = (fates[i] == CellFate::diverged) == (rho[i] > 1 + 1e-9);
      outside += !agrees && std::abs(rho[i] - 1) >= 2 * std::log(threshold) / steps;
      diverged += fates[i] == CellFate::diverged;
    }
    BOOST_TEST(outside == 0, name);
    BOOST_TEST(diverged > times(20, 1), name);
  }
}

BOOST_AUTO_TEST_CASE(bad_files_get_one_line) {
  const auto refused = [](const std::string& text, const std::string& place, const std::string& words) {
    expect_error([&] { parse_method("m.json", text); }, place, words);
  };
  const std::string rk = "{\"name\": \"m\", \"kind\": \"runge-kutta\",\n";
  refused("[]", "m.json:1", "the method is an array, expected an object");
  refused("{\"name\": \"m\"}", "m.json:1", "'kind' is missing");
  refused("{\"name\": \"m\", \"kind\": \"rk\"}", "m.json:1", "'kind' is 'rk', expected");
  refused(rk + "\"B\": [1]}", "m.json:2", "unknown key 'B' in the method");
  refused(rk + "\"A\": [[]],\n\"A\": [[]], \"b\": [1]}", "m.json:3", "duplicate key 'A'");
  refused(rk + "\"A\": [[]]}", "m.json:1", "'b' is missing");
  refused(rk + "\"b\": [1],\n\"A\": [[], []]}", "m.json:3", "'A' has 2 rows, expected 1");
  refused(rk + "\"b\": [1],\n\"A\": [[1, 2]]}", "m.json:3", "'A'[0] has 2 entries, expected 0 to 1");
  refused(rk + "\"b\": [\"1/0\"], \"A\": [[]]}", "m.json:2",
          "'b'[0] is '1/0', expected a number, or a fraction");
  refused(rk + "\"b\": [\"1/2\", \"1/3\"], \"A\": [[], [1]]}", "m.json:1",
          "inconsistent: the sum of b is 0.833333333333, expected 1");
  refused(rk + "\"b\": [0, 1], \"A\": [[], [0.5]],\n\"c\": [0,\n0.4]}", "m.json:4",
          "inconsistent: 'c'[1] is 0.4, expected 0.5");
  refused("{\"name\": \"a b\", \"kind\": \"runge-kutta\", \"A\": [[]], \"b\": [1]}", "m.json:1", "letters");
  const std::string steps = "{\"name\": \"m\", \"kind\": \"multistep\", ";
  refused(steps + "\"form\": \"third\", \"alpha\": [-1, 1], \"beta\": [1, 0]}", "m.json:1",
          "'form' is 'third'");
  refused(steps + "\"form\": \"first-order\", \"alpha\": [-1, 1.1], \"beta\": [1, 0]}", "m.json:1",
          "inconsistent: rho(1), the sum of alpha, is 0.1, expected 0");
  refused(steps + "\"form\": \"first-order\", \"alpha\": [-1, 1], \"beta\": [0.5, 0]}", "m.json:1",
          "inconsistent: rho'(1) is 1, expected sigma(1), which is 0.5");
  refused(steps + "\"form\": \"first-order\", \"alpha\": [-1, 1], \"beta\": [1]}", "m.json:1",
          "'beta' has 1 entries, expected 2");
  refused(steps + "\"form\": \"first-order\", \"alpha\": [1, 0], \"beta\": [1, 0]}", "m.json:1", "not 0");
  const std::string second = steps + "\"form\": \"second-order\", \"alpha\": [1, -2, 1], ";
  refused(second + "\"beta\": [0, 1, 0]}", "m.json:1", "'velocity' is missing");
  refused(second + "\"beta\": [0, 2, 0], \"velocity\": {\"x\": [0, -1, 1]}}", "m.json:1",
          "inconsistent: rho''(1) is 2, expected 2 sigma(1), which is 4");
  refused(second + "\"beta\": [0, 1, 0], \"velocity\": {\"x\": [0, -2, 2]}}", "m.json:1",
          "inconsistent: the sum of j x_j of the velocity is 2, expected 1");
}

// On the command line, a file's method is one of those that are listed, and the one that is meant where none
// is named.
BOOST_AUTO_TEST_CASE(the_command_takes_a_file) {
  const Command springstab;
  const std::string file = " --method-file '" + folder + "kutta3.json'";
  const Outcome region = springstab("region --nx 20 --ny 20 --json" + file);
  BOOST_REQUIRE(region.status == 0);
  BOOST_TEST(region.json()["method"] == "kutta3");
  BOOST_TEST(std::abs(region.json()["y_max"].get<double>() - 6.44156) < 5e-6);
  const auto last = [](const nlohmann::json& list) { return list.back()["name"].get<std::string>(); };
  BOOST_TEST(last(springstab("methods --json" + file).json()["methods"]) == "kutta3");
  const Outcome limits = springstab("limits --grid 4x4 --pin corners --json" + file);
  BOOST_TEST(limits.json()["methods"].size() == all_methods().size() + 1);
  BOOST_TEST(last(limits.json()["methods"]) == "kutta3");
  for (const char* each : {"kutta3", "crouzeix3", "gauss2", "bdf3", "stormer", "verlet_pair"}) {
    const Outcome run = springstab(
        "simulate --grid 4x4 --pin corners --duration 0.02 --step 0.0002 --json "
        "--method-file '" +
        folder + each + ".json'");
    BOOST_TEST(run.status == 0, each << ": " << run.err);
  }
  // Consistent, of order 3, and never stable: ρ has the root -5.
  const std::string unstable =
      springstab
          .file("unstable.json", R"({"name": "unstable", "kind": "multistep", "form": "first-order",
                                          "alpha": [-5, 4, 1], "beta": [2, 4, 0]})")
          .string();
  const Outcome amplifies = springstab("region --nx 20 --ny 20 --method-file '" + unstable + "'");
  BOOST_TEST(amplifies.status == 0);
  BOOST_TEST(amplifies.out.find("no X, Y is stable: the method amplifies") != std::string::npos,
             amplifies.out);
  const Outcome no_step =
      springstab("limits --grid 4x4 --pin corners --method unstable --json --method-file '" + unstable + "'");
  BOOST_TEST(no_step.status == 3);
  BOOST_TEST(no_step.json()["methods"][0]["status"] == "none");
  const Outcome bad =
      springstab("region --method-file '" + springstab.file("bad.json", "{\n\"kind\": 1}").string() + "'");
  BOOST_TEST(bad.status == 2);
  BOOST_TEST(bad.err.find("bad.json:2: 'kind' is 1, expected a word") != std::string::npos, bad.err);
  const Outcome taken = springstab(
      "region --method-file '" +
      springstab.file("rk4.json", R"({"name": "rk4", "kind": "runge-kutta", "A": [[]], "b": [1]})").string() +
      "'");
  BOOST_TEST(taken.status == 2);
  BOOST_TEST(taken.err.find("the name 'rk4' is another method's, expected a new one") != std::string::npos);
  const Outcome none = springstab("region");
  BOOST_TEST(none.status == 2);
  BOOST_TEST(none.err.find("METHOD is required") != std::string::npos, none.err);
}

BOOST_AUTO_TEST_SUITE_END()
