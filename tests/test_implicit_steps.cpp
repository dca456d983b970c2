// The laws of implicit steps: which part of the damping they take, where that leaves them stable, and what
// more Newton steps make of them.
#include <Eigen/Dense>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <string>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/split_damping.h"
#include "analysis/structure_limits.h"
#include "solvers/counting.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/spring_chain.h"
#include "tests/command.h"
#include "tests/random_nets.h"

BOOST_AUTO_TEST_SUITE(implicit_steps)

using namespace springstab;
using namespace springstab::test;
using boost::test_tools::tolerance;

namespace {

const char* const diagonal = "implicit-damping-euler:part=diagonal";
const char* const all_of_it = "implicit-damping-euler";

SparseMatrix sparse(const Eigen::MatrixXd& a) { return a.sparseView(); }

class RandomMatrices {
 public:
  explicit RandomMatrices(std::uint64_t seed) : engine_(seed) {}
  Eigen::MatrixXd semidefinite(Eigen::Index n, Eigen::Index rank) {
    const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return normal_(engine_); });
    return b * b.transpose();
  }
  Vector vector(Eigen::Index n) {
    return Vector::NullaryExpr(n, [&] { return normal_(engine_); });
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// v⁺ of (M + hD_i)(v⁺ - v) = -h(Kx + Dv).
Vector kicked(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m, const Eigen::MatrixXd& d,
              const Eigen::MatrixXd& implicit, double h, const State<Vector>& s) {
  return s.v - Eigen::MatrixXd(m + h * implicit).llt().solve(Vector(h * (k * s.x + d * s.v)));
}

Eigen::MatrixXd diagonal_of(const Eigen::MatrixXd& a) { return a.diagonal().asDiagonal(); }

/// x'' = -sin x - (0.3 + 0.1 v²) v - c_i x_i of two coupled pendulums: nonlinear in x and in v.
class Pendulums final : public System {
 public:
  Eigen::Index size() const override { return 2; }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    out = -x.array().sin() - (0.3 + 0.1 * v.array().square()) * v.array();
    out[0] -= 0.7 * (x[0] - x[1]) + 0.2 * (v[0] - v[1]);
    out[1] += 0.7 * (x[0] - x[1]) + 0.2 * (v[0] - v[1]);
  }
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override {
    Eigen::Matrix2d coupling{{1, -1}, {-1, 1}};
    Eigen::Matrix2d k = 0.7 * coupling, d = 0.2 * coupling;
    k.diagonal().array() += x.array().cos();
    d.diagonal().array() += 0.3 + 0.3 * v.array().square();
    linear = std::make_shared<MatrixSystem>(StructuralMatrices{
        .stiffness = sparse(k), .mass = sparse(Eigen::Matrix2d::Identity()), .damping = sparse(d)});
  }
  double kinetic_energy(const Vector& v) override { return v.squaredNorm() / 2; }
  double potential_energy(const Vector&) override { return 0; }
};

State<Vector> start_of_pendulums() { return {Vector{{1.1, -0.4}}, Vector{{-0.4, 0.9}}, {}}; }

const char* const implicit_methods[] = {"implicit-euler",
                                        "newmark",
                                        "newmark:beta=0.1,gamma=0.6",
                                        "newmark:rule=central-difference",
                                        "hht-alpha",
                                        "generalized-alpha",
                                        "generalized-alpha:rho=0.2",
                                        "bdf2",
                                        "trapezoidal",
                                        "sdirk2",
                                        "tr-bdf2",
                                        all_of_it};

/// Where a run of `steps` equal steps to t = 2 ends.
State<Vector> run(System& system, const State<Vector>& begin, const char* method, int steps, int newton) {
  const auto stepper = Method(method).stepper();
  stepper->set_newton({.steps = newton});
  State<Vector> state = begin;
  stepper->start(system, 2. / steps, state);
  for (int i = 0; i < steps; ++i)
    BOOST_REQUIRE((stepper->step(system, 2. / steps, state) == StepStatus::done));
  return state;
}

double distance(const State<Vector>& a, const State<Vector>& b) {
  return std::sqrt((a.x - b.x).squaredNorm() + (a.v - b.v).squaredNorm());
}

void check_order(System& system, const State<Vector>& begin, int newton, const char* what) {
  const State<Vector> exact = run(system, begin, "rk4", 4000, 1);
  for (const char* name : implicit_methods) {
    const double order = Method(name).info().order;
    for (const int steps : {40, 80, 160}) {
      const double measured = std::log2(distance(run(system, begin, name, steps, newton), exact) /
                                        distance(run(system, begin, name, 2 * steps, newton), exact));
      BOOST_TEST((measured > order - 0.3 && measured < order + 0.4), name << ", " << what << ", " << newton
                                                                          << " Newton steps, " << steps
                                                                          << " steps: order " << measured);
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(matrices_take_the_part_that_a_method_asks_for) {
  RandomMatrices random(1);
  for (int trial = 0; trial < 20; ++trial) {
    constexpr Eigen::Index n = 7;
    const Eigen::MatrixXd k = 50 * random.semidefinite(n, n), d = random.semidefinite(n, 3),
                          offered = random.semidefinite(n, 2),
                          m = Eigen::MatrixXd::Identity(n, n) + 0.3 * random.semidefinite(n, n);
    const double h = 0.03;
    const State<Vector> before{random.vector(n), random.vector(n), {}};
    MatrixSystem one(prepare(sparse(k), sparse(m), sparse(d))),
        two(prepare(sparse(k), sparse(m), sparse(d), {}, sparse(offered)));
    const auto check = [&](System& system, const char* method, const Eigen::MatrixXd& damping,
                           const Eigen::MatrixXd& implicit) {
      State<Vector> state = before;
      const auto stepper = Method(method).stepper();
      for (int i = 0; i < 3; ++i) {  // what is kept of a factorization serves as well
        const Vector v = kicked(k, m, damping, implicit, h, state), x = state.x + h * v;
        BOOST_REQUIRE((stepper->step(system, h, state) == StepStatus::done));
        BOOST_TEST((state.v - v).norm() <= 1e-12 * v.norm(), method);
        BOOST_TEST((state.x - x).norm() <= 1e-12 * x.norm(), method);
      }
    };
    check(one, all_of_it, d, d);
    check(one, diagonal, d, diagonal_of(d));
    check(two, all_of_it, d + offered, offered);
    check(two, diagonal, d + offered, diagonal_of(offered));
    check(two, "implicit-damping-euler:part=all", d + offered, offered);
    State<Vector> state = before;  // every other method adds them up
    Method("implicit-euler").stepper()->step(two, h, state);
    const Eigen::MatrixXd sum = d + offered, system = m + h * sum + h * h * k;
    BOOST_TEST((state.v - system.llt().solve(Vector(m * before.v - h * k * before.x))).norm() <=
               1e-12 * state.v.norm());
  }
}

BOOST_AUTO_TEST_CASE(without_damping_no_part_of_it_is_missed) {
  RandomMatrices random(6);
  const Eigen::MatrixXd k = random.semidefinite(4, 4), none = Eigen::MatrixXd::Zero(4, 4);
  MatrixSystem system(prepare(sparse(k)));
  State<Vector> state{random.vector(4), random.vector(4), {}};
  const Vector v = kicked(k, Eigen::MatrixXd::Identity(4, 4), none, none, 0.1, state);
  BOOST_REQUIRE((Method(diagonal).stepper()->step(system, 0.1, state) == StepStatus::done));
  BOOST_TEST((state.v - v).norm() <= 1e-14 * v.norm());
  GeneralDamping limits(system.matrices(), stiffest_mode(system.matrices()),
                        {.kind = DampingModel::Kind::general}, 1.5, true);
  BOOST_TEST(limits.limits(diagonal).h_max.value() == limits.limits("symplectic-euler").h_max.value(),
             tolerance(1e-6));
}

BOOST_AUTO_TEST_CASE(scenes_and_chains_take_the_diagonal_of_their_matrices) {
  RandomMatrices random(2);
  const double h = 0.004;
  SpringNet net = make_net(Grid{.rows = 3, .columns = 4}, SpringMaterial{});
  for (std::size_t i = 0; i < net.springs.size(); ++i) net.springs[i].damping = 0.01 * double(1 + i % 3);
  Scene scene(net, {0, 3}, {0, -9.81, 0}, RayleighDamping{.d0 = 0.7, .alpha = 2e-3});
  State<Vector> state = scene.rest_state();
  state.x += 1e-3 * random.vector(state.x.size());
  state.v = random.vector(state.x.size());
  const StructuralMatrices s = structure_of(scene, state).matrices;
  Vector a;
  scene.acceleration(state.x, state.v, a);
  const Eigen::MatrixXd m(s.mass), d(s.damping);
  Vector expected = state.v + Eigen::MatrixXd(m + h * diagonal_of(d)).llt().solve(Vector(h * (m * a)));
  BOOST_REQUIRE((Method(diagonal).stepper()->step(scene, h, state) == StepStatus::done));
  BOOST_TEST((state.v - expected).norm() <= 1e-12 * expected.norm());

  SpringChain chain({1, 0.5, 2}, {300, 20, 100, 50}, {.d0 = 0.4, .alpha = 0.02});
  const Eigen::MatrixXd k(chain.matrices().stiffness), masses(chain.matrices().mass);
  const Eigen::MatrixXd damping = 0.4 * masses + 0.02 * k;
  state = {random.vector(3), random.vector(3), {}};
  expected = kicked(k, masses, damping, diagonal_of(damping), h, state);
  BOOST_REQUIRE((Method(diagonal).stepper()->step(chain, h, state) == StepStatus::done));
  BOOST_TEST((state.v - expected).norm() <= 1e-13 * expected.norm());
}

// λ_max(h²K' + 2hD_e' - 2hD_i') = 4 at the limit: stable below by dense eigenvalues of the step, not above.
BOOST_AUTO_TEST_CASE(damping_that_is_implicit_in_part_has_its_exact_limit) {
  RandomNets random(3);
  RandomMatrices more(4);
  const HalfPlane condition = explicit_condition(all_of_it);
  BOOST_TEST((condition.x == 2 && condition.y == 1 && condition.bound == 4));
  int smaller = 0;
  for (int trial = 0; trial < 40; ++trial) {
    StructuralMatrices s = matrices(random.net(true));
    const Eigen::Index n = s.size();
    const bool offered = trial % 2 == 0;
    if (offered) {
      s.implicit_damping = sparse(random.log_uniform(-3, 1) * more.semidefinite(n, n / 2));
      s.damping = SparseMatrix(s.damping + s.implicit_damping);
    }
    const char* const method = offered && trial % 4 == 0 ? all_of_it : diagonal;
    const Eigen::MatrixXd root = Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd k = root * s.stiffness * root, d = root * s.damping * root;
    const Eigen::MatrixXd whole = root * (offered ? s.implicit_damping : s.damping) * root;
    const Eigen::MatrixXd implicit = method == diagonal ? diagonal_of(whole) : whole;
    GeneralDamping limits(s, stiffest_mode(s), {.kind = DampingModel::Kind::general}, 1.5, true);
    const MethodLimits l = limits.limits(method);
    BOOST_REQUIRE((l.h_max && l.h_certified && l.recommended));
    const double h = *l.h_max;
    const double largest = Eigen::MatrixXd(h * h * k + 2 * h * (d - 2 * implicit))
                               .selfadjointView<Eigen::Lower>()
                               .eigenvalues()
                               .maxCoeff();
    BOOST_TEST(largest == 4, tolerance(1e-7));
    BOOST_TEST((l.source == LimitSource::exact && l.proof == Proof::matrix_condition));
    BOOST_TEST((*l.h_certified <= h && *l.h_certified > 0.999 * h));
    BOOST_TEST(*l.recommended < h);
    BOOST_TEST(largest_modulus(transition_matrix(s, method, 0.999 * h)) < 1 + 1e-7);
    BOOST_TEST(largest_modulus(transition_matrix(s, method, 1.001 * h)) > 1 + 1e-7);
    smaller += h < *limits.limits("symplectic-euler").h_max * (1 - 1e-9);
  }
  BOOST_TEST(smaller == 0);  // damping taken implicitly never shortens the step
}

// With Rayleigh damping D commutes with K, its diagonal does not.
BOOST_AUTO_TEST_CASE(the_diagonal_of_rayleigh_damping_is_not_of_modes) {
  const SpringChain chain({1, 0.5, 2, 0.1}, {300, 20, 100, 50, 700}, {.d0 = 0.4, .alpha = 0.02});
  StructureLimits answer(structure_of(chain));
  const StructuralMatrices s = prepare(chain.matrices().stiffness, chain.matrices().mass, {}, {0.4, 0.02});
  const double h = answer.limits(diagonal).h_max.value();
  BOOST_TEST(h != answer.limits(all_of_it).h_max.value(), tolerance(1e-3));
  BOOST_TEST(largest_modulus(transition_matrix(s, diagonal, 0.999 * h)) < 1);
  BOOST_TEST(largest_modulus(transition_matrix(s, diagonal, 1.001 * h)) > 1);
  BOOST_TEST(answer.limits(diagonal).h_certified.value() <= h);
  // from matrices it is the same
  StructureLimits again(structure_of(s));
  BOOST_TEST(again.limits(diagonal).h_max.value() == h, tolerance(1e-9));
  // what is d0 M alone has one diagonal; alpha that is left to the design is 0
  StructureLimits designed(Structure{chain.matrices(), {DampingModel::Kind::designed, 0.4}});
  const MethodLimits l = designed.limits(diagonal);
  const double k0 = designed.k0().value;
  BOOST_TEST(*l.h_max == (0.4 + std::sqrt(0.16 + 4 * k0)) / k0, tolerance(1e-9));  // h²k0 = 4 + 2h·0.4
  BOOST_TEST((!l.designed && designed_alpha(Method(diagonal), *l.h_max, 0.4) == 0));
}

BOOST_AUTO_TEST_CASE(every_implicit_method_has_its_order_with_any_number_of_newton_steps) {
  Pendulums pendulums;
  for (const int newton : {1, 2, 20}) check_order(pendulums, start_of_pendulums(), newton, "nonlinear");
  RandomMatrices random(5);
  const Eigen::MatrixXd k = random.semidefinite(3, 3), d = 0.5 * random.semidefinite(3, 2);
  MatrixSystem linear(prepare(sparse(k), {}, sparse(d)));
  check_order(linear, {random.vector(3), random.vector(3), {}}, 1, "linear");
}

// The equations of the methods themselves, to the tolerance of the iteration.
BOOST_AUTO_TEST_CASE(newton_steps_solve_the_equations_of_a_step) {
  Pendulums system;
  const double h = 0.4;
  const auto a = [&](const Vector& x, const Vector& v) {
    Vector out;
    system.acceleration(x, v, out);
    return out;
  };
  const auto after = [&](const char* method, int newton) {
    const auto stepper = Method(method).stepper();
    stepper->set_newton({.steps = newton});
    State<Vector> state = start_of_pendulums();
    stepper->start(system, h, state);
    const State<Vector> before = state;
    BOOST_REQUIRE((stepper->step(system, h, state) == StepStatus::done));
    return std::pair(before, state);
  };
  const auto residual = [&](const std::string& method, int newton) -> double {
    const auto [b, e] = after(method.c_str(), newton);
    if (method == "implicit-euler") return (e.v - b.v - h * a(e.x, e.v)).norm();
    if (method == all_of_it) return (e.v - b.v - h * a(b.x, e.v)).norm();
    if (method == "trapezoidal") return (e.v - b.v - h / 2 * (a(b.x, b.v) + a(e.x, e.v))).norm();
    if (method == "newmark") return (e.memory[0] - a(e.x, e.v)).norm();
    if (method == "generalized-alpha") {  // ρ = 0.8: α_m = 1/3, α_f = 4/9
      const double w = 5. / 9;
      return (2. / 3 * e.memory[0] + b.memory[0] / 3 - a(b.x + w * (e.x - b.x), b.v + w * (e.v - b.v)))
          .norm();
    }
    BOOST_REQUIRE(method == "bdf2");
    return (e.v - (4 * b.v - b.memory[1]) / 3 - 2 * h / 3 * a(e.x, e.v)).norm();
  };
  for (const char* name :
       {"implicit-euler", "implicit-damping-euler", "trapezoidal", "newmark", "generalized-alpha", "bdf2"}) {
    const double one = residual(name, 1), two = residual(name, 2), three = residual(name, 3);
    BOOST_TEST(one > 1e-7, name);  // BDF2's start has taken one already
    BOOST_TEST(two < 0.5 * one, name);
    BOOST_TEST(three < 30 * two * two + 1e-14, name);  // of the second order
    BOOST_TEST(residual(name, 50) < 1e-12, name);
  }
}

BOOST_AUTO_TEST_CASE(newton_stops_at_its_tolerance_and_one_step_is_the_method_itself) {
  for (const char* name : implicit_methods) {
    Pendulums pendulums;
    CountingSystem counted(pendulums);
    const auto stepper = Method(name).stepper(), plain = Method(name).stepper();
    BOOST_TEST(stepper->set_newton({.steps = 1}), name);
    State<Vector> state = start_of_pendulums(), same = state;
    stepper->start(counted, 0.1, state);
    plain->start(pendulums, 0.1, same);
    stepper->step(counted, 0.1, state);
    plain->step(pendulums, 0.1, same);
    BOOST_TEST((state.x == same.x && state.v == same.v), name);
    const auto linearizations = [&](NewtonOptions options) {
      stepper->set_newton(options);
      const long before = counted.counts().hessian_assemblies;
      State<Vector> from = state;
      stepper->step(counted, 0.1, from);
      return counted.counts().hessian_assemblies - before;
    };
    const long one = linearizations({.steps = 1});
    const long stages = linearizations({.steps = 2, .tolerance = 0}) - one;
    BOOST_TEST(stages >= 1, name);
    BOOST_TEST(linearizations({.steps = 3, .tolerance = 0}) == one + 2 * stages, name);
    BOOST_TEST(linearizations({.steps = 9, .tolerance = 1e9}) == one + stages, name);
    BOOST_TEST(linearizations({.steps = 99}) < one + 8 * stages, name);
  }
  for (const char* name : {"rk4", "symplectic-euler", "velocity-verlet", "linearized-rk4", "rkc2", diagonal})
    BOOST_TEST(!Method(name).stepper()->set_newton({.steps = 3}), name);
}

BOOST_FIXTURE_TEST_CASE(the_command_takes_matrices_for_implicit_damping, Command) {
  file("K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 300\n2 1 -100\n2 2 200\n");
  file("De.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 3\n2 1 -3\n2 2 3\n");
  file("Di.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 8\n2 2 1\n");
  const auto h_max = [&](const std::string& arguments) {
    const Outcome outcome = (*this)("limits --stiffness K.mtx --json " + arguments);
    BOOST_REQUIRE(outcome.status == 0);
    return outcome.json()["methods"][0]["h_max"].get<double>();
  };
  const Eigen::Matrix2d k{{300, -100}, {-100, 200}}, explicit_part{{3, -3}, {-3, 3}},
      implicit{{8, 0}, {0, 1}};
  const auto largest = [&](double h, const Eigen::Matrix2d& d) {
    return Eigen::Matrix2d(h * h * k + 2 * h * d).selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  };
  const std::string both = "--damping-matrix De.mtx --implicit-damping-matrix Di.mtx --method ";
  BOOST_TEST(largest(h_max(both + "implicit-damping-euler"), explicit_part - implicit) == 4, tolerance(1e-7));
  BOOST_TEST(largest(h_max(both + "symplectic-euler"), explicit_part + implicit) == 4, tolerance(1e-7));
  BOOST_TEST(
      largest(h_max("--implicit-damping-matrix Di.mtx --method implicit-damping-euler"), -implicit) == 4,
      tolerance(1e-7));
  const Eigen::Matrix2d sign{{-3, -3}, {-3, -3}};  // D - 2 diag D
  BOOST_TEST(largest(h_max("--damping-matrix De.mtx --method " + std::string(diagonal)), sign) == 4,
             tolerance(1e-7));
  BOOST_TEST((*this)("simulate --stiffness K.mtx " + both + "implicit-damping-euler --duration 1").status ==
             0);
  const Outcome alone = (*this)("limits --grid 3x3 --implicit-damping-matrix Di.mtx");
  BOOST_TEST((alone.status == 2 && alone.err.find("go with --stiffness") != std::string::npos));
  file("bad.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 2 8\n");
  const Outcome bad =
      (*this)("simulate --stiffness K.mtx --implicit-damping-matrix bad.mtx --method rk4 --duration 1");
  BOOST_TEST(
      (bad.status == 2 && bad.err.find("implicit damping matrix is not symmetric") != std::string::npos));
}

BOOST_FIXTURE_TEST_CASE(the_command_takes_newton_steps_and_says_who_has_no_use_for_them, Command) {
  const std::string cloth = "simulate --grid 4x4 --pin first-row --duration 0.2 --step 0.005 --json ";
  const auto energy = [&](const std::string& more) {
    const Outcome outcome = (*this)(cloth + more);
    BOOST_REQUIRE(outcome.status == 0);
    return outcome.json()["energy"]["final"].get<double>();
  };
  BOOST_TEST(energy("--method implicit-euler") == energy("--method implicit-euler --newton 1"));
  const double two = energy("--method implicit-euler --newton 2"),
               many = energy("--method implicit-euler --newton 30");
  BOOST_TEST(std::abs(two - many) < 0.2 * std::abs(energy("--method implicit-euler") - many));
  const auto told = [&](const std::string& arguments, const std::string& reason) {
    const Outcome outcome = (*this)(arguments + " --newton 3");
    BOOST_TEST(outcome.err.find("--newton has no use here: " + reason) != std::string::npos, outcome.err);
  };
  told(cloth + "--method rk4", "rk4 solves no equations");
  told(cloth + "--method " + std::string(diagonal), std::string(diagonal));
  file("K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 300\n");
  told("simulate --stiffness K.mtx --method bdf2 --duration 1", "one Newton step solves linear equations");
  BOOST_TEST((*this)(cloth + "--method bdf2 --newton 0").status == 2);
}

BOOST_FIXTURE_TEST_CASE(parameters_that_amplify_are_told, Command) {
  for (const char* name : {"newmark:gamma=0.4", "generalized-alpha:rho=1.1"}) {
    BOOST_TEST((*this)("region " + std::string(name)).out.find("the method amplifies") != std::string::npos,
               name);
    for (const char* input : {"--grid 4x4 --pin first-row", "--stiffness K.mtx --rayleigh 3,0.01"}) {
      file("K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 300\n");
      const std::string out = (*this)("limits " + std::string(input) + " --methods rk4," + name).out;
      BOOST_TEST(out.find("undamped motion grows at every step: " + std::string(name)) != std::string::npos,
                 out);
    }
  }
  for (const char* name : {"newmark", "generalized-alpha:rho=1", "explicit-euler", "rkc2"})
    BOOST_TEST((*this)("region " + std::string(name)).out.find("amplifies") == std::string::npos, name);
}

BOOST_AUTO_TEST_SUITE_END()
