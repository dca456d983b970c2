// The laws of a method's step: its matrix on one mode, its order, and what a step may and may not touch.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "allocation_counter.h"
#include "analysis/method.h"
#include "analysis/regions/amplification.h"
#include "analysis/regions/stability_region.h"
#include "oracles.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/methods/list.h"
#include "solvers/oscillator.h"

BOOST_AUTO_TEST_SUITE(methods)

using namespace springstab;
using oracles::epsilon;
using oracles::Point;

namespace {

/// Points all over the plane, and some of every magnitude and sign.
std::vector<Point> random_points() {
  std::mt19937_64 random(20250211);
  std::uniform_real_distribution<double> x(-4, 9), y(-5, 12), exponent(-6, 3);
  std::bernoulli_distribution negative(0.3);
  std::vector<Point> points;
  for (int i = 0; i < 600; ++i) points.push_back({x(random), y(random)});
  const auto any_size = [&] { return (negative(random) ? -1 : 1) * std::pow(10, exponent(random)); };
  for (int i = 0; i < 300; ++i) {
    const double first = any_size();
    points.push_back({first, any_size()});
  }
  return points;
}

/// Those of both lists, and more parameters of some.
std::vector<Method> every_method() {
  std::vector<Method> methods = built_in_methods();
  for (const char* name : {"newmark:beta=0.1,gamma=0.6", "newmark:rule=central-difference",
                           "generalized-alpha:rho=0.3", "rkc2:stages=9"})
    methods.emplace_back(name);
  return methods;
}

std::vector<std::unique_ptr<Stepper>> all_steppers() {
  std::vector<std::unique_ptr<Stepper>> steppers;
  for (const Method& method : every_method()) steppers.push_back(method.stepper());
  return steppers;
}

/// x'' = -sin x - (0.3 + 0.1 v²) v: nonlinear in both, so that neither Jacobian is constant.
class Pendulum final : public System {
 public:
  static double slope(double x, double v) { return -std::sin(x) - (0.3 + 0.1 * v * v) * v; }

  Eigen::Index size() const override { return 1; }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    out.setConstant(1, slope(x[0], v[0]));
  }
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override {
    auto tangent = std::make_shared<Tangent>();
    tangent->k = std::cos(x[0]);
    tangent->d = 0.3 + 0.3 * v[0] * v[0];
    linear = std::move(tangent);
  }
  double kinetic_energy(const Vector& v) override { return v[0] * v[0] / 2; }
  double potential_energy(const Vector& x) override { return 1 - std::cos(x[0]); }

 private:
  struct Tangent final : LinearSystem {
    double k = 0, d = 0;
    Eigen::Index size() const override { return 1; }
    void acceleration(const Vector& x, const Vector& v, Vector& out) override { out = -k * x - d * v; }
    void stiffness_times(const Vector& u, Vector& out) override { out = k * u; }
    void damping_times(const Vector& u, Vector& out) override { out = d * u; }
    SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override {
      out = rhs / (shift.mass + shift.damping * d + shift.stiffness * k);
      return {};
    }
    double kinetic_energy(const Vector& v) override { return v[0] * v[0] / 2; }
    double potential_energy(const Vector& x) override { return k * x[0] * x[0] / 2; }
  };
};

/// (x, v) of the pendulum at time t by Dormand and Prince's method of order 8, to `tolerance`.
std::array<double, 2> reference(double x, double v, double t, double tolerance) {
  gsl_odeiv2_system equations{[](double, const double s[], double rate[], void*) {
                                rate[0] = s[1];
                                rate[1] = Pendulum::slope(s[0], s[1]);
                                return static_cast<int>(GSL_SUCCESS);
                              },
                              nullptr, 2, nullptr};
  const std::unique_ptr<gsl_odeiv2_driver, void (*)(gsl_odeiv2_driver*)> driver(
      gsl_odeiv2_driver_alloc_y_new(&equations, gsl_odeiv2_step_rk8pd, 1e-2, tolerance, 0),
      gsl_odeiv2_driver_free);
  std::array<double, 2> s{x, v};
  double now = 0;
  BOOST_REQUIRE(gsl_odeiv2_driver_apply(driver.get(), &now, t, s.data()) == GSL_SUCCESS);
  return s;
}

/// A chain of n unit masses between two walls, its springs damped and unequal, without a heap allocation of
/// its own.
class Chain final : public LinearSystem {
 public:
  explicit Chain(Eigen::Index n) : spring_(n + 1), shifted_(n), work_(n) {
    for (Eigen::Index i = 0; i <= n; ++i) spring_[i] = 50 + 7 * static_cast<double>(i % 5);
  }
  int failing_call = 0;                        // counted from 1: this acceleration is NaN
  StepStatus solve_status = StepStatus::done;  // what a solve reports

  Eigen::Index size() const override { return work_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    out.resize(size());
    for (Eigen::Index i = 0; i < size(); ++i) out[i] = -stiffness(x, i) - 0.01 * stiffness(v, i) - 0.2 * v[i];
    if (++calls_ == failing_call) out[size() / 2] = std::numeric_limits<double>::quiet_NaN();
  }
  void stiffness_times(const Vector& u, Vector& out) override {
    out.resize(size());
    for (Eigen::Index i = 0; i < size(); ++i) out[i] = stiffness(u, i);
  }
  void damping_times(const Vector& u, Vector& out) override {
    out.resize(size());
    for (Eigen::Index i = 0; i < size(); ++i) out[i] = 0.01 * stiffness(u, i) + 0.2 * u[i];
  }
  /// Tridiagonal elimination.
  SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override {
    const double scale = shift.damping * 0.01 + shift.stiffness;
    out = rhs;
    for (Eigen::Index i = 0; i < size(); ++i) {
      shifted_[i] = shift.mass + 0.2 * shift.damping + scale * (spring_[i] + spring_[i + 1]);
      if (i == 0) continue;
      const double factor = -scale * spring_[i] / shifted_[i - 1];
      shifted_[i] += factor * scale * spring_[i];
      out[i] -= factor * out[i - 1];
    }
    for (Eigen::Index i = size(); i-- > 0;) {
      if (i + 1 < size()) out[i] += scale * spring_[i + 1] * out[i + 1];
      out[i] /= shifted_[i];
    }
    return {.status = solve_status};
  }
  double kinetic_energy(const Vector& v) override { return v.squaredNorm() / 2; }
  double potential_energy(const Vector& x) override {
    stiffness_times(x, work_);
    return x.dot(work_) / 2;
  }
  void restart() { calls_ = 0; }
  int calls() const { return calls_; }

 private:
  double stiffness(const Vector& u, Eigen::Index i) const {
    const double left = i > 0 ? u[i - 1] : 0, right = i + 1 < size() ? u[i + 1] : 0;
    return spring_[i] * (u[i] - left) - spring_[i + 1] * (right - u[i]);
  }
  Vector spring_, shifted_, work_;
  int calls_ = 0;
};

State<Vector> random_state(Eigen::Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  State<Vector> state;
  state.x = Vector::NullaryExpr(n, draw);
  state.v = Vector::NullaryExpr(n, draw);
  return state;
}

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

bool same_bits(const State<Vector>& a, const State<Vector>& b) {
  return same_bits(a.x, b.x) && same_bits(a.v, b.v) &&
         std::equal(a.memory.begin(), a.memory.end(), b.memory.begin(), b.memory.end(),
                    [](const Vector& u, const Vector& w) { return same_bits(u, w); });
}

SparseMatrix sparse(const Eigen::MatrixXd& a) { return a.sparseView(); }

}  // namespace

BOOST_AUTO_TEST_CASE(names_are_unique_and_find_their_method) {
  for (const Method& method : every_method()) {
    BOOST_TEST((Method(method.name()) == method), "the name " << method.name() << " finds another method");
    BOOST_TEST(method.stepper() != nullptr);
    BOOST_TEST(!method.info().title.empty());
    BOOST_TEST(method.info().order >= 1);
  }
  for (const auto& oracle : oracles::all()) BOOST_TEST(Method(oracle.method).name() == oracle.method);
}

BOOST_AUTO_TEST_CASE(an_unknown_name_is_refused_with_the_known_ones) {
  for (const std::string name : {"", "rk3", "RK4", "rk4 ", "explicit"}) {
    const auto lists_all = [&](const std::invalid_argument& error) {
      const std::string what = error.what();
      bool all = what.find("'" + name + "'") != std::string::npos;
      for (const Method& method : built_in_methods())
        all = all && what.find(method.name()) != std::string::npos;
      return all;
    };
    BOOST_CHECK_EXCEPTION(Method(name).stepper(), std::invalid_argument, lists_all);
    BOOST_CHECK_EXCEPTION(stability_region(name), std::invalid_argument, lists_all);
  }
}

BOOST_AUTO_TEST_CASE(the_matrix_of_a_step_is_the_papers) {
  for (const Method& method : all_methods()) {
    const oracles::Oracle* oracle = oracles::find(method.name());
    if (!oracle) continue;
    for (const auto& [x, y] : random_points()) {
      const Eigen::Matrix2d a = method.amplification(x, y);
      const Eigen::Array22d error = (a - oracle->matrix(x, y)).array().abs();
      BOOST_TEST((error <= 16 * epsilon * oracle->matrix_size(x, y).array()).all(),
                 method.name() << " at (" << x << ", " << y << "):\n"
                               << a << "\nexpected\n"
                               << oracle->matrix(x, y));
    }
  }
}

BOOST_AUTO_TEST_CASE(the_eigenvalues_of_a_step_are_the_stability_functions) {
  int with_function = 0;
  for (const Method& method : all_methods()) {
    const oracles::Oracle* oracle = oracles::find(method.name());
    if (!oracle) continue;
    with_function += oracle->has_stability_function();
    for (const auto& [x, y] : random_points()) {
      const auto [value, error] = oracles::eigenvalues(method.amplification(x, y), oracle->matrix_size(x, y));
      const double distance = oracles::distance(value, oracle->eigenvalues(x, y));
      BOOST_TEST(distance <= error, method.name()
                                        << " at (" << x << ", " << y << "): " << value[0] << ", " << value[1]
                                        << ", off by " << distance << ", expected below " << error);
    }
  }
  BOOST_TEST(with_function == 4);  // all but symplectic Euler
}

BOOST_AUTO_TEST_CASE(the_formula_of_a_step_has_the_values_of_the_step) {
  for (const Method& method : all_methods()) {
    const std::vector<RationalFunction> formula = method.symbolic_step();
    const oracles::Oracle* oracle = oracles::find(method.name());
    for (const auto& [x, y] : random_points()) {
      const Eigen::Matrix2d a = method.amplification(x, y);
      const Eigen::Matrix2d size = oracle ? oracle->matrix_size(x, y)
                                          : Eigen::Matrix2d::Constant(1e4 * (1 + a.norm()) * (1 + a.norm()));
      const Eigen::Matrix2d b{{formula[0](x, y), formula[1](x, y)}, {formula[2](x, y), formula[3](x, y)}};
      BOOST_TEST(((a - b).array().abs() <= 32 * epsilon * size.array()).all(),
                 method.name() << " at (" << x << ", " << y << "):\n"
                               << a << "\nby the formula\n"
                               << b);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_measured_order_of_accuracy_is_the_stated_one) {
  const double x0 = 1.1, v0 = -0.4, t = 2;
  const auto exact = reference(x0, v0, t, 1e-14), rougher = reference(x0, v0, t, 1e-12);
  const double doubt = std::hypot(exact[0] - rougher[0], exact[1] - rougher[1]);
  Pendulum pendulum;
  for (const Method& method : every_method()) {
    const auto stepper = method.stepper();
    const auto error = [&](int steps) {
      State<Vector> state{Vector::Constant(1, x0), Vector::Constant(1, v0)};
      stepper->start(pendulum, t / steps, state);
      for (int i = 0; i < steps; ++i)
        BOOST_REQUIRE(stepper->step(pendulum, t / steps, state) == StepStatus::done);
      return std::hypot(state.x[0] - exact[0], state.v[0] - exact[1]);
    };
    for (const int steps : {25, 50, 100}) {
      const double coarse = error(steps), fine = error(2 * steps);
      BOOST_TEST(fine > 100 * doubt, method.name() << ": the reference is too rough");
      const double order = std::log2(coarse / fine);
      BOOST_TEST(order > method.info().order - 0.3, method.name()
                                                        << " in " << steps << " steps: order " << order);
      BOOST_TEST(order < method.info().order + 0.4, method.name()
                                                        << " in " << steps << " steps: order " << order);
    }
  }
}

// theory: explicit Euler with D0 + hK takes the steps of drift-kick symplectic Euler with D0.
BOOST_AUTO_TEST_CASE(explicit_euler_with_alpha_h_is_symplectic_euler_on_an_oscillator) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.1, 1.9);
  for (int trial = 0; trial < 200; ++trial) {
    const double h = 0.01 * uniform(random), d0 = uniform(random);
    const double k = uniform(random) * (2 - h * d0) / (h * h);  // symplectic Euler's stable steps
    State<double> explicit_state{uniform(random), uniform(random)}, symplectic_state = explicit_state;
    const double scale = std::abs(symplectic_state.x) + std::abs(symplectic_state.v) / std::sqrt(k);
    ExplicitEuler::Steps<double> explicit_euler;
    SymplecticEuler::Steps<double> symplectic_euler;
    Oscillator<double> damped{.k = k, .d = d0 + h * k}, soft{.k = k, .d = d0};
    double moved = 0;
    for (int i = 0; i < 50; ++i) {
      explicit_euler.step(damped, h, explicit_state);
      symplectic_euler.step(soft, h, symplectic_state);
      moved = std::max(moved, std::abs(symplectic_state.x));
      BOOST_TEST_REQUIRE(std::abs(explicit_state.x - symplectic_state.x) <= 1e-11 * scale);
      BOOST_TEST_REQUIRE(std::abs(explicit_state.v - symplectic_state.v) <= 1e-11 * scale * std::sqrt(k));
    }
    BOOST_TEST(moved > 0.1 * scale);
  }
}

BOOST_AUTO_TEST_CASE(explicit_euler_with_alpha_h_is_symplectic_euler_on_matrices_that_do_not_commute) {
  constexpr Eigen::Index n = 12;
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  const auto semidefinite = [&](Eigen::Index rank) {
    const Eigen::MatrixXd b = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return normal(random); });
    return Eigen::MatrixXd(b * b.transpose());
  };
  const Eigen::MatrixXd stiffness = 100 * semidefinite(n), damping = 0.5 * semidefinite(3);
  const Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(n, n) + semidefinite(n);
  BOOST_REQUIRE((stiffness * damping - damping * stiffness).norm() > 0.1 * stiffness.norm() * damping.norm());

  const double h = 0.004;
  MatrixSystem soft(prepare(sparse(stiffness), sparse(mass), sparse(damping)));
  MatrixSystem damped(prepare(sparse(stiffness), sparse(mass), sparse(damping + h * stiffness)));
  State<Vector> symplectic_state = random_state(n, 9), explicit_state = symplectic_state;
  const auto symplectic_euler = Method("symplectic-euler").stepper(),
             explicit_euler = Method("explicit-euler").stepper();
  double largest = 0, moved = 0;
  const State<Vector> start = symplectic_state;
  for (int i = 0; i < 300; ++i) {
    BOOST_REQUIRE(symplectic_euler->step(soft, h, symplectic_state) == StepStatus::done);
    BOOST_REQUIRE(explicit_euler->step(damped, h, explicit_state) == StepStatus::done);
    largest = std::max(largest, symplectic_state.v.norm());
    moved = std::max(moved, (symplectic_state.x - start.x).norm());
    BOOST_TEST_REQUIRE((symplectic_state.x - explicit_state.x).norm() <= 1e-11 * largest);
    BOOST_TEST_REQUIRE((symplectic_state.v - explicit_state.v).norm() <= 1e-11 * largest);
  }
  BOOST_TEST(largest < 100 * start.v.norm());  // a stable step: the agreement is not that of two infinities
  BOOST_TEST(moved > start.x.norm());
}

BOOST_AUTO_TEST_CASE(a_failed_step_leaves_the_state_bit_for_bit) {
  Chain chain(9);
  for (const Method& method : every_method()) {
    const auto stepper = method.stepper();
    State<Vector> before = random_state(9, 10);
    chain.failing_call = 0;
    stepper->start(chain, 0.01, before);
    State<Vector> state = before;
    chain.restart();
    BOOST_TEST_REQUIRE((stepper->step(chain, 0.01, state) == StepStatus::done));
    BOOST_TEST(!same_bits(state, before), method.name() << " did not move");
    const int calls = chain.calls();
    BOOST_TEST_REQUIRE(calls >= 1);
    for (int failing = 1; failing <= calls; ++failing) {
      state = before;
      chain.failing_call = failing;
      chain.restart();
      BOOST_TEST((stepper->step(chain, 0.01, state) == StepStatus::diverged), method.name());
      BOOST_TEST(same_bits(state, before), method.name() << ": evaluation " << failing << " failed");
    }
    chain.failing_call = 0;
    state.v[3] = std::numeric_limits<double>::max();  // overflows in the springs
    const State<Vector> huge = state;
    BOOST_TEST((stepper->step(chain, 1e3, state) == StepStatus::diverged), method.name());
    BOOST_TEST(same_bits(state, huge), method.name());
  }
}

BOOST_AUTO_TEST_CASE(an_implicit_step_passes_on_how_its_solve_failed) {
  Chain chain(9);
  int implicit = 0;
  for (const Method& method : every_method()) {
    for (const StepStatus failure : {StepStatus::not_positive_definite, StepStatus::not_converged}) {
      const auto stepper = method.stepper();
      State<Vector> before = random_state(9, 11);
      stepper->start(chain, 0.01, before);
      State<Vector> state = before;
      chain.solve_status = failure;
      const StepStatus status = stepper->step(chain, 0.01, state);
      chain.solve_status = StepStatus::done;
      BOOST_TEST((status == (method.info().implicit ? failure : StepStatus::done)), method.name());
      BOOST_TEST(same_bits(state, before) == method.info().implicit, method.name());
      implicit += method.info().implicit;
    }
  }
  BOOST_TEST(implicit >= 2);
}

BOOST_AUTO_TEST_CASE(a_step_depends_on_the_state_alone) {
  Chain chain(9), other(23);
  for (const auto& stepper : all_steppers()) {
    State<Vector> before = random_state(9, 12), unrelated = random_state(9, 13),
                  longer = random_state(23, 14);
    stepper->start(chain, 0.013, before);
    stepper->start(chain, 0.02, unrelated);
    stepper->start(other, 0.02, longer);
    State<Vector> first = before, second = before;
    BOOST_REQUIRE(stepper->step(chain, 0.013, first) == StepStatus::done);
    BOOST_REQUIRE(stepper->step(chain, 0.02, unrelated) == StepStatus::done);
    BOOST_REQUIRE(stepper->step(other, 0.02, longer) == StepStatus::done);
    BOOST_REQUIRE(stepper->step(chain, 0.013, second) == StepStatus::done);
    BOOST_TEST(same_bits(first, second));
  }
}

BOOST_AUTO_TEST_CASE(a_system_of_any_vector_type_takes_the_same_step) {
  const auto check = [](const auto& description) {
    using Three = Eigen::Array3d;
    Oscillator<double> one{.k = 3.7, .d = 0.9};
    Oscillator<Three> three{.k = {3.7, 1, 9}, .d = {0.9, 2, 0}};
    State<double> scalar{0.4, -1.3};
    State<Three> lanes{{0.4, 1, 2}, {-1.3, 0, 5}};
    auto steps = make_steps<double>(description);
    auto lane_steps = make_steps<Three>(description);
    start_steps(steps, description.info().memory, one, 0.21, scalar);
    start_steps(lane_steps, description.info().memory, three, 0.21, lanes);
    BOOST_TEST((steps.step(one, 0.21, scalar) == StepStatus::done));
    BOOST_TEST((lane_steps.step(three, 0.21, lanes) == StepStatus::done));
    BOOST_TEST(lanes.x[0] == scalar.x, description.info().name);
    BOOST_TEST(lanes.v[0] == scalar.v, description.info().name);
  };
  Methods::for_each(check);
  MoreMethods::for_each(check);
}

BOOST_AUTO_TEST_CASE(only_the_first_step_allocates) {
  constexpr Eigen::Index n = 40;
  Chain chain(n);
  for (const Method& method : every_method()) {
    const auto stepper = method.stepper();
    State<Vector> state = random_state(n, 15);
    stepper->start(chain, 0.01, state);
    const long before = allocations();
    BOOST_REQUIRE(stepper->step(chain, 0.01, state) == StepStatus::done);
    const long warm = allocations();
    bool done = true;
    for (int i = 0; i < 10; ++i) done = stepper->step(chain, 0.01, state) == StepStatus::done && done;
    const long after = allocations();
    BOOST_TEST(done, method.name());
    BOOST_TEST(warm > before, method.name() << ": nothing was counted in the first step");
    BOOST_TEST(after == warm, method.name() << ": " << after - warm << " allocations in ten steps");
  }
}

BOOST_AUTO_TEST_SUITE_END()
