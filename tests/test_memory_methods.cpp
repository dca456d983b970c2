// The laws of the methods of finite elements and of stiff problems, and of those that carry more than x and
// v: regions against closed forms, against spectral radii and against simulated cells; limits of structures
// against dense eigenvalues.
#include <Eigen/LU>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/transient_growth.h"
#include "analysis/regions/amplification.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/rigid_motions.h"
#include "analysis/spectra/spectrum.h"
#include "solvers/methods/parameters.h"
#include "solvers/simulation.h"
#include "tests/instruments.h"
#include "tests/random_nets.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(memory_methods)

using namespace springstab;
using namespace springstab::test;
using boost::test_tools::tolerance;

namespace {

const char* const carrying[] = {"newmark",
                                "newmark:beta=0.1,gamma=0.6",
                                "newmark:rule=linear-acceleration",
                                "newmark:rule=central-difference",
                                "hht-alpha",
                                "hht-alpha:alpha=-0.6",
                                "hht-alpha:alpha=0.1",
                                "generalized-alpha",
                                "generalized-alpha:rho=0.2",
                                "generalized-alpha:rho=1.1",
                                "bdf2"};
const char* const second_order[] = {
    "velocity-verlet", "trapezoidal",           "sdirk2", "tr-bdf2", "nystrom4",
    "rkc2:stages=3",   "implicit-damping-euler"};

std::vector<std::string> all_new() {
  std::vector<std::string> names(std::begin(carrying), std::end(carrying));
  names.insert(names.end(), std::begin(second_order), std::end(second_order));
  return names;
}

double radius(const Method& method, double x, double y) {
  return largest_modulus(method.amplification(x, y));
}

/// The symmetric multistep method (z - 1)²(z² + 1), σ = ½z³ + z² + ½z, damped by (x⁺ - x⁻)/2h.
struct Symmetric {
  MethodInfo info() const { return {"symmetric", "symmetric", 2, false, false, 3, StepChange::restart}; }
  template <class V>
  struct Steps {
    template <class System>
    void start(System&, double h, State<V>& state) {
      for (std::size_t i = 0; i < 3; ++i) state.memory[i] = state.x - (h * double(i + 1)) * state.v;
    }
    template <Accelerating<V> System>
    StepStatus step(System& system, double h, State<V>& state) {
      const V &x1 = state.memory[0], &x2 = state.memory[1], &x3 = state.memory[2];
      older.resize(3);
      v = (0.5 / h) * (state.x - x2);
      system.acceleration(state.x, v, a);
      x = 2.0 * state.x - 2.0 * x1 + 2.0 * x2 - x3 + (0.5 * h * h) * a;
      system.acceleration(x1, v, a);
      x = x + (h * h) * a;
      system.acceleration(x2, v, a);
      x = x + (0.5 * h * h) * a;
      v = (1 / h) * (x - state.x);
      older = {state.x, x1, x2};
      return commit(state, x, v, older);
    }
    V x, v, a;
    std::vector<V> older;
  };
};

}  // namespace

// Newmark(β, γ) is stable iff X + (γ - ½)Y > 0 and (2γ - 4β)Y < 4 + (4γ - 2)X.
BOOST_AUTO_TEST_CASE(newmark_has_the_region_of_its_inequalities) {
  std::mt19937_64 random(19);
  std::uniform_real_distribution<double> of_beta(0, 0.4), of_gamma(0.3, 0.9), of_x(0, 8), of_y(0, 20);
  long stable = 0, unstable = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const double beta = of_beta(random), gamma = of_gamma(random);
    const Method method("newmark:beta=" + std::to_string(beta) +
                        ",gamma=" + std::to_string(gamma));  // six digits of each
    const double b = std::stod(std::to_string(beta)), g = std::stod(std::to_string(gamma));
    std::vector<double> x, y, rho(1000);
    for (int i = 0; i < 1000; ++i) x.push_back(of_x(random)), y.push_back(of_y(random));
    spectral_radius(method, x, y, rho);
    for (std::size_t i = 0; i < rho.size(); ++i) {
      const bool expected = x[i] + (g - 0.5) * y[i] > 0 && (2 * g - 4 * b) * y[i] < 4 + (4 * g - 2) * x[i];
      BOOST_TEST((rho[i] < 1) == expected, method.name() << " at " << x[i] << ", " << y[i]);
      (expected ? stable : unstable) += 1;
    }
    for (const double at : {0.7, 3.1}) {  // the exact column, from Y = 0 on
      const auto column = stability_region(method).stable_intervals({{{at}}, {{0, 1}}}, 0, 1e6);
      double top = 2 * g > 4 * b ? (4 + (4 * g - 2) * at) / (2 * g - 4 * b) : 1e6;
      if (g < 0.5) top = std::min(top, at / (0.5 - g));
      BOOST_REQUIRE(column.size() == 1);
      BOOST_TEST(column[0].lower == 0);
      BOOST_TEST(column[0].upper == top, tolerance(1e-10));
    }
  }
  BOOST_TEST((stable > 2000 && unstable > 2000));
}

BOOST_AUTO_TEST_CASE(newmarks_rules_have_their_limits) {
  const auto imaginary = [](const char* name) {
    return stability_region(name).constants().imaginary_interval;
  };
  BOOST_TEST(imaginary("newmark:rule=central-difference") == 2, tolerance(1e-12));
  BOOST_TEST(imaginary("newmark:rule=linear-acceleration") == std::sqrt(12.0), tolerance(1e-12));
  BOOST_TEST(std::isinf(imaginary("newmark")));
  const HalfPlane condition = stability_region("newmark:beta=0.1,gamma=0.6").exact_condition().value();
  BOOST_TEST(condition.x / condition.bound == -0.1, tolerance(1e-12));
  BOOST_TEST(condition.y / condition.bound == 0.2, tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(velocity_verlet_has_its_curved_region) {
  const StabilityRegion& region = stability_region("velocity-verlet");
  const auto top = [&](double x) { return region.stable_intervals({{{x}}, {{0, 1}}}, 0, 1e3).front().upper; };
  BOOST_TEST(region.constants().imaginary_interval == 2, tolerance(1e-12));
  for (const auto& [x, y] : {std::pair{0.5, 25. / 7}, {1, 10. / 3}, {1.5, 3.4}, {2, 4}, {2.5, 17. / 3}})
    BOOST_TEST(top(x) == y, tolerance(1e-12));
  double least = 10;
  for (double x = 0.8; x < 1.2; x += 1e-3) least = std::min(least, top(x));
  BOOST_TEST(least == 8 * (std::numbers::sqrt2 - 1), tolerance(1e-6));
  BOOST_TEST(region.constants().real_interval == 4, tolerance(1e-12));
  BOOST_TEST(std::isinf(region.constants().y_max));
  // k = 1, d = 1: stable to h = 2, and again from 2√2 to 4
  BOOST_TEST(region.critical_step(1, 1) == 2, tolerance(1e-12));
  const auto again = region.stable_intervals({{{0, 1}}, {{0, 0, 1}}}, 0, 10);
  BOOST_REQUIRE(again.size() == 2);
  BOOST_TEST(again[1].lower == 2 * std::numbers::sqrt2, tolerance(1e-12));
  BOOST_TEST(again[1].upper == 4, tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(methods_stable_at_every_step_cover_the_quadrant) {
  for (const char* name :
       {"newmark", "hht-alpha:alpha=0", "hht-alpha:alpha=-0.05", "hht-alpha:alpha=-0.3",
        "hht-alpha:alpha=-0.4", "generalized-alpha", "generalized-alpha:rho=0", "generalized-alpha:rho=1",
        "generalized-alpha:rho=-0.5", "bdf2", "trapezoidal", "sdirk2", "tr-bdf2"})
    BOOST_TEST(stability_region(name).constants().covers_quadrant, name);
  for (const char* name : {"hht-alpha:alpha=-0.6", "hht-alpha:alpha=0.1", "generalized-alpha:rho=1.1",
                           "newmark:gamma=0.4", "implicit-damping-euler"})
    BOOST_TEST(!stability_region(name).constants().covers_quadrant, name);
  for (const auto& [name, limit] : {std::pair{"generalized-alpha:rho=0.2", 0.2},
                                    {"generalized-alpha:rho=0.8", 0.8},
                                    {"generalized-alpha:rho=1", 1.0},
                                    {"sdirk2", 0.0},
                                    {"tr-bdf2", 0.0},
                                    {"bdf2", 0.0},
                                    {"trapezoidal", 1.0}})
    BOOST_TEST(std::abs(radius(name, 3, 1e10) - limit) < 2 * std::pow(1e10, -0.25), name);
}

BOOST_AUTO_TEST_CASE(explicit_methods_have_their_published_intervals) {
  for (const auto& [stages, interval] :
       {std::pair{2, 2.0}, {3, 6.1802}, {5, 16.6028}, {10, 64.7381}, {20, 260.7526}}) {
    if (stages > times(20, 5)) continue;
    const Method method("rkc2:stages=" + std::to_string(stages));
    const RegionConstants& c = stability_region(method).constants();
    BOOST_TEST(std::abs(c.real_interval - interval) < 5.1e-5, method.name());
    BOOST_TEST(c.imaginary_interval == 0, method.name());
    if (stages > 2) BOOST_TEST(c.y_max >= 0.9999 * interval * interval, method.name());
  }
}

// Where the third condition says nothing: on X = 0 the roots come in reciprocal pairs, until two meet.
BOOST_AUTO_TEST_CASE(a_symmetric_multistep_method_is_lost_where_roots_meet) {
  const Method method = make_method(Symmetric());
  const StabilityRegion& region = stability_region(method);
  const double lost = 12 - 8 * std::numbers::sqrt2;  // 0.6863
  BOOST_TEST(region.constants().imaginary_interval == std::sqrt(lost), tolerance(1e-9));
  BOOST_TEST(std::abs(radius(method, 0, 0.99 * lost) - 1) < 1e-9);
  BOOST_TEST(radius(method, 0, 1.01 * lost) > 1.01);
}

// On random lines every point of a stable interval has a radius below 1, and every point outside above.
BOOST_AUTO_TEST_CASE(intervals_along_any_line_are_those_of_the_radii) {
  std::mt19937_64 random(20);
  std::uniform_real_distribution<double> position(-3, 9), slope(-2, 2);
  std::vector<std::string> names = all_new();
  for (const std::string& name : names) {
    const Method method(name);
    const StabilityRegion& region = stability_region(method);
    int inside = 0, outside = 0;
    for (int line = 0; line < 60; ++line) {
      const double x0 = position(random), y0 = position(random), dx = slope(random), dy = slope(random);
      const auto intervals = region.stable_intervals({{{x0, dx}}, {{y0, dy}}}, -4, 4);
      for (int i = 0; i < 40; ++i) {
        const double t = -4 + 8 * (i + 0.5) / 40;
        double distance = 1e9;  // to the nearest end
        bool stable = false;
        for (const StableInterval& s : intervals) {
          stable = stable || (t > s.lower && t < s.upper);
          distance = std::min({distance, std::abs(t - s.lower), std::abs(t - s.upper)});
        }
        if (distance < 1e-6) continue;
        const double rho = radius(method, x0 + dx * t, y0 + dy * t);
        // an eigenvalue that is -1 everywhere is left aside by the region
        BOOST_TEST((stable ? rho < 1 + 1e-9 : rho > 1 - 1e-9),
                   name << " at " << x0 + dx * t << ", " << y0 + dy * t << ": " << rho);
        (stable ? inside : outside) += 1;
      }
    }
    BOOST_TEST((inside > 20 || name == "generalized-alpha:rho=1.1"), name);
    BOOST_TEST(outside > 20, name);
  }
}

BOOST_AUTO_TEST_CASE(radii_by_lanes_are_those_of_the_eigenvalues) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> exponent(-4, 4);
  for (const std::string& name : all_new()) {
    const Method method(name);
    std::vector<double> x, y, rho(2003);
    for (std::size_t i = 0; i < rho.size(); ++i)
      x.push_back(std::pow(10, exponent(random))), y.push_back(std::pow(10, exponent(random)));
    spectral_radius(method, x, y, rho);
    for (std::size_t i = 0; i < rho.size(); ++i) {
      const double expected = radius(method, x[i], y[i]);
      BOOST_TEST(std::abs(rho[i] - expected) <= 1e-6 * std::max(1.0, expected),
                 name << " at " << x[i] << ", " << y[i] << ": " << rho[i] << ", eigenvalues " << expected);
    }
  }
}

BOOST_AUTO_TEST_CASE(simulated_cells_agree_with_the_region_outside_the_band,
                     *boost::unit_test::label("slow")) {
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> of_x(-1, 7), of_y(-1, 14);
  constexpr long steps = 1000;
  constexpr double threshold = 1e6;
  for (const std::string& name : all_new()) {
    std::vector<double> x, y, rho(4000);
    std::vector<CellFate> fates(rho.size());
    for (std::size_t i = 0; i < rho.size(); ++i) x.push_back(of_x(random)), y.push_back(of_y(random));
    spectral_radius(Method(name), x, y, rho);
    simulate_cells(Method(name), x, y, steps, threshold, fates);
    long decayed = 0, diverged = 0;
    for (std::size_t i = 0; i < rho.size(); ++i) {
      const bool agrees = (fates[i] == CellFate::diverged) == (rho[i] > 1 + 1e-9);
      const bool in_band = std::abs(rho[i] - 1) < 2 * std::log(threshold) / steps;
      BOOST_TEST((agrees || in_band), name << " at " << x[i] << ", " << y[i] << ": rho " << rho[i]);
      decayed += fates[i] == CellFate::decayed;
      diverged += fates[i] == CellFate::diverged;
    }
    BOOST_TEST(diverged > 20, name);
    BOOST_TEST((decayed > 20 || name == "generalized-alpha:rho=1.1"), name);
  }
}

// Of nets whose D' and K' do not commute: what is certified is stable, what is exact is the first step that
// is not, and what is unlimited is stable at any step.
BOOST_AUTO_TEST_CASE(limits_of_nets_are_below_the_truth_of_dense_eigenvalues) {
  RandomNets random(23);
  int exact = 0, certified = 0, unlimited = 0, none = 0, known = 0;
  for (int trial = 0; trial < times(12, 3); ++trial) {
    // else a double eigenvalue 1, which rounding moves by its root
    const StructuralMatrices s = without_rigid_motions(matrices(random.net(trial % 2 == 0)));
    const StiffestMode k0 = stiffest_mode(s);
    GeneralDamping limits(s, k0, {.kind = DampingModel::Kind::general}, 1.5, true);
    const auto growth = [&](const std::string& name, double h) {
      return largest_modulus(transition_matrix(s, name, h));
    };
    for (const std::string& name : all_new()) {
      const MethodLimits l = limits.limits(Method(name));
      if (l.status == LimitStatus::unlimited) {
        for (const double part : {0.1, 1.0, 10.0, 1000.0})
          BOOST_TEST(growth(name, part / std::sqrt(k0.value)) < 1 + 1e-7, name);
        unlimited += 1;
        continue;
      }
      if (l.status == LimitStatus::none) {
        BOOST_TEST((stability_region(Method(name)).amplifies() && !l.h_certified), name);
        // At much smaller steps what hht-alpha:alpha=0.1 grows by, as h³, is less than rounding of an
        // eigenvalue.
        for (const double part : {0.1, 1.0})
          BOOST_TEST(growth(name, part / std::sqrt(k0.value)) > 1 + 1e-9, name);
        none += 1;
        continue;
      }
      if (!l.h_certified) BOOST_TEST(!l.unproved.empty(), name);
      if (l.h_max) {
        BOOST_TEST(growth(name, 0.999 * *l.h_max) < 1 + 1e-7, name);
        const bool hardly = stability_region(Method(name)).amplifies();  // by as little as rounding
        BOOST_TEST((growth(name, 1.001 * *l.h_max) > 1 || hardly), name);
        known += 1;
      }
      if (l.h_certified) {
        if (l.h_max) BOOST_TEST(*l.h_certified <= *l.h_max, name);
        for (const double part : {0.3, 0.7, 0.9999})  // at the limit itself -1 may be a double eigenvalue
          BOOST_TEST(growth(name, part * *l.h_certified) < 1 + 1e-7, name);
        certified += 1;
      }
      if (l.h_max && stability_region(Method(name)).exact_condition()) {
        BOOST_TEST(growth(name, 1.001 * *l.h_max) > 1 + 1e-7, name);
        BOOST_TEST(*l.h_certified > 0.999 * *l.h_max, name);
        exact += 1;
      }
    }
  }
  BOOST_TEST_MESSAGE(exact << " exact, " << known << " known, " << certified << " certified, " << unlimited
                           << " unlimited, " << none << " without a stable step");
  BOOST_TEST((exact >= times(40, 10) && known > exact && certified > exact && unlimited >= times(60, 15)));
}

// Velocity Verlet is stable exactly while hD' < 4 and h²K' + 2hD' < 4(1 - hD'/4)⁻¹ as matrices, up to the
// first step at which that fails.
BOOST_AUTO_TEST_CASE(velocity_verlet_has_its_own_condition_on_matrices) {
  RandomNets random(29);
  int by_damping = 0, compared = 0;
  for (int trial = 0; trial < 15; ++trial) {
    StructuralMatrices s = without_rigid_motions(matrices(random.net(true)));
    s.damping *= random.log_uniform(0, 1.5);
    const Eigen::MatrixXd root = Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd k = root * s.stiffness * root, d = root * s.damping * root;
    const auto holds = [&](double h) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> left(
          Eigen::MatrixXd(Eigen::MatrixXd::Identity(s.size(), s.size()) - h / 4 * d));
      if (!(left.eigenvalues().minCoeff() > 0)) return false;
      const Eigen::MatrixXd half = left.operatorSqrt();
      return (half * (h * h * k + 2 * h * d) * half)
                 .selfadjointView<Eigen::Lower>()
                 .eigenvalues()
                 .maxCoeff() < 4;
    };
    GeneralDamping limits(s, stiffest_mode(s), {.kind = DampingModel::Kind::general}, 1.5, true);
    const MethodLimits l = limits.limits("velocity-verlet");
    if (!l.h_max || !l.h_certified) continue;  // a motion is undamped
    compared += 1;
    for (int i = 1; i < 1000; ++i) BOOST_TEST(holds(i * 1e-3 * *l.h_max));
    BOOST_TEST((holds(*l.h_max * (1 - 1e-6)) && !holds(*l.h_max * (1 + 1e-6))));
    BOOST_TEST((*l.h_certified <= *l.h_max && *l.h_certified > 0.98 * *l.h_max));
    BOOST_TEST(*l.recommended < *l.h_max);
    by_damping += *l.h_max < 1.9 / std::sqrt(stiffest_mode(s).value);
  }
  BOOST_TEST((compared >= 8 && by_damping > 0 && by_damping < compared));
}

BOOST_AUTO_TEST_CASE(methods_whose_modes_are_not_scalar_are_known_by_their_steps) {
  for (const char* name : {"rk4", "trapezoidal", "sdirk2", "tr-bdf2", "implicit-euler", "rkc2"})
    BOOST_TEST((stability_region(name).matrix_form() == MatrixForm::stability_function), name);
  for (const char* name : {"symplectic-euler", "newmark", "generalized-alpha", "generalized-alpha:rho=1",
                           "hht-alpha", "bdf2", "implicit-damping-euler"})
    BOOST_TEST((stability_region(name).matrix_form() == MatrixForm::scalar_coefficients), name);
  for (const char* name : {"velocity-verlet", "nystrom4"})
    BOOST_TEST((stability_region(name).matrix_form() == MatrixForm::none), name);
}

// λ_max(h²K' - 2hD') = 4 for the damping taken implicitly.
BOOST_AUTO_TEST_CASE(implicit_damping_has_its_exact_limit) {
  const HalfPlane c = stability_region("implicit-damping-euler").exact_condition().value();
  BOOST_TEST((c.x == -2 && c.y == 1 && c.bound == 4));
  RandomNets random(24);
  const StructuralMatrices s = matrices(random.net(false));
  const double h = exact_limit(NumericalRange(s), c).value();
  BOOST_TEST(h > 2 / std::sqrt(stiffest_mode(s).value));
}

// Steps measured by bisection on runs of MuJoCo 3, a chain between two walls: its Euler takes the dampers at
// the joints implicitly and those along the springs explicitly, its implicitfast the diagonal of both.
BOOST_AUTO_TEST_CASE(a_physics_engine_diverges_where_its_method_does) {
  const auto file = shared_data("engines/mujoco_chain.json");
  if (!file) return;
  const nlohmann::json chain = nlohmann::json::parse(std::ifstream(*file));
  const auto numbers = [&](const char* key) { return chain.at(key).get<std::vector<double>>(); };
  const std::vector<double> mass = numbers("mass"), joint = numbers("joint_damping");
  const auto n = static_cast<Eigen::Index>(mass.size());
  const auto between_walls = [&](const char* key) {
    const std::vector<double> k = numbers(key);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      a(i, i) = k[at] + k[at + 1];
      if (i > 0) a(i, i - 1) = a(i - 1, i) = -k[at];
    }
    return a;
  };
  const auto diagonal = [&](const std::vector<double>& d) {
    return Eigen::MatrixXd(Eigen::Map<const Eigen::VectorXd>(d.data(), n).asDiagonal());
  };
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(n, n), dampers = between_walls("damping");
  const auto limit = [&](const char* method, const Eigen::MatrixXd& damping,
                         const Eigen::MatrixXd& implicit = {}) {
    const StructuralMatrices s = prepare(
        SparseMatrix(between_walls("stiffness").sparseView()), SparseMatrix(diagonal(mass).sparseView()),
        SparseMatrix(damping.sparseView()), {}, SparseMatrix(implicit.sparseView()));
    const StiffestMode k0 = stiffest_mode(s);
    if (damping.isZero()) return *method_limits(method, k0, {}, 1.5).h_max;
    return *GeneralDamping(s, k0, {.kind = DampingModel::Kind::general}, 1.5, false).limits(method).h_max;
  };
  const auto measured = [&](const char* which) {
    return chain.at("largest_stable_step").at(which).get<double>();
  };
  for (const char* method : {"symplectic-euler", "implicit-damping-euler", "newmark:rule=central-difference"})
    BOOST_TEST(limit(method, none) == measured("Euler, no damping"), tolerance(1e-4));
  BOOST_TEST(limit("implicit-damping-euler", diagonal(joint)) == measured("Euler, joint dampers"),
             tolerance(1e-4));
  BOOST_TEST(limit("implicit-damping-euler", dampers, diagonal(joint)) == measured("Euler, both"),
             tolerance(1e-4));
  BOOST_TEST(limit("implicit-damping-euler", dampers, none) == measured("Euler, spring dampers"),
             tolerance(1e-4));
  BOOST_TEST(limit("implicit-damping-euler:part=diagonal", dampers + diagonal(joint)) ==
                 measured("implicitfast, both"),
             tolerance(1e-4));
  BOOST_TEST(limit("symplectic-euler", dampers) == measured("Euler, spring dampers"), tolerance(1e-4));
  BOOST_TEST(limit("rk4", none) == measured("RK4, no damping"), tolerance(1e-4));
  BOOST_TEST(limit("rk4", dampers + diagonal(joint)) == measured("RK4, both"), tolerance(1e-4));
}

BOOST_AUTO_TEST_CASE(a_damped_run_grows_no_further_than_its_method_lets_it) {
  // an undamped mode keeps its energy under the average acceleration, from any x and v on
  BOOST_TEST(transient_growth("newmark", 0, 1.7) == 1, tolerance(1e-9));
  BOOST_TEST(transient_growth("generalized-alpha", 0.3, 1.7) < 1.1);
  BOOST_TEST(transient_growth("newmark:rule=central-difference", 1e-4, 3.9) > 2);
}

BOOST_AUTO_TEST_CASE(a_line_is_designed_for_methods_of_any_region) {
  const DampingDesign none = design_damping(stability_region("bdf2"), 100, 0.3);
  BOOST_TEST((std::isinf(none.h_max) && none.alpha == 0));
  const StabilityRegion& verlet = stability_region("velocity-verlet");
  const DampingDesign line = design_damping(verlet, 100, 0);
  BOOST_TEST(line.h_max > 0.2);  // without damping
  for (int i = 1; i < 200; ++i) {
    const double k = 0.5 * i, d = line.alpha * k, h = line.h_max * (1 - 1e-9);
    BOOST_TEST(radius("velocity-verlet", h * d, h * h * k) <= 1 + 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(a_method_is_made_from_its_text) {
  BOOST_TEST((Method("newmark:beta=0.1") == Method("newmark:beta=0.1")));
  BOOST_TEST(!(Method("newmark:beta=0.1") == Method("newmark:beta=0.2")));
  BOOST_TEST(Method("newmark:beta=0.1,gamma=0.5").name() == "newmark:beta=0.1,gamma=0.5");
  BOOST_TEST(Method("generalized-alpha").size() == 3);
  const auto says = [](const std::string& words) {
    return [words](const std::invalid_argument& e) {
      return std::string(e.what()).find(words) != std::string::npos;
    };
  };
  for (const auto& [text, words] :
       {std::pair{"newmark:beta=x", "beta is 'x', expected a number"},
        {"newmark:betta=1", "unknown parameter 'betta', expected one of beta, gamma, rule"},
        {"newmark:beta", "'beta' stands where key=value is expected"},
        {"newmark:beta=1,beta=1", "beta is given twice"},
        {"newmark:beta=-1", "not negative"},
        {"newmark:rule=magic", "central-difference"},
        {"rk4:x=1", "unknown parameter 'x', expected none"},
        {"rkc2:stages=1", "between 2 and 200"},
        {"rkc2:stages=2.5", "expected a whole number"},
        {"generalized-alpha:rho=-1", "between -1 and 2"},
        {"nothing:a=1", "unknown method 'nothing'"}})
    BOOST_CHECK_EXCEPTION(Method{text}, std::invalid_argument, says(words));
}

// A run in two parts, what is carried kept between them, ends in the bits of one run.
BOOST_AUTO_TEST_CASE(a_run_goes_on_from_what_was_carried) {
  RandomNets random(25);
  const StructuralMatrices s = matrices(random.net(true));
  for (const char* name : {"newmark", "hht-alpha", "generalized-alpha", "bdf2"}) {
    MatrixSystem system(s), other(s);
    const Method method(name);
    const auto stepper = method.stepper(), second = method.stepper();
    State<Vector> whole{Vector::Ones(s.size()), Vector::LinSpaced(s.size(), -1, 2)};
    stepper->start(system, 0.01, whole);
    State<Vector> part = whole;
    for (int i = 0; i < 60; ++i) stepper->step(system, 0.01, whole);
    for (int i = 0; i < 23; ++i) stepper->step(system, 0.01, part);
    const State<Vector> kept = part;
    for (int i = 0; i < 37; ++i) second->step(other, 0.01, part);
    BOOST_TEST((part.x == whole.x && part.v == whole.v && part.memory == whole.memory), name);
    BOOST_TEST((kept.x - whole.x).norm() > 0, name);
  }
}

// Without damping Newmark's average acceleration and the trapezoidal rule keep the energy, and the others of
// order 2 lose some of it.
BOOST_AUTO_TEST_CASE(energy_is_kept_or_lost_as_the_method_says) {
  RandomNets random(26);
  StructuralMatrices s = matrices(random.net(false));
  s.damping = SparseMatrix();
  MatrixSystem system(s);
  const auto kept = [&](const char* name) {
    State<Vector> state{Vector::Ones(s.size()), Vector::Zero(s.size())};
    const auto energy = [&] { return system.kinetic_energy(state.v) + system.potential_energy(state.x); };
    const double before = energy();
    const auto stepper = Method(name).stepper();
    stepper->start(system, 0.1, state);
    for (int i = 0; i < 200; ++i) BOOST_REQUIRE(stepper->step(system, 0.1, state) == StepStatus::done);
    return energy() / before;
  };
  for (const char* name : {"newmark", "trapezoidal", "hht-alpha:alpha=0", "generalized-alpha:rho=1"})
    BOOST_TEST(kept(name) == 1, tolerance(1e-6));
  for (const char* name : {"bdf2", "sdirk2", "tr-bdf2", "hht-alpha", "generalized-alpha"})
    BOOST_TEST(kept(name) < 0.99, name);
}

BOOST_AUTO_TEST_SUITE_END()
