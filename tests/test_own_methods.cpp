// Methods that a user brings, among them ones that carry vectors beyond x and v: they have all that a
// built-in one has, from nothing but their step.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/transient_growth.h"
#include "analysis/method.h"
#include "analysis/proofs/inscribed_polygon.h"
#include "analysis/regions/amplification.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/transition_operator.h"
#include "experiments/runs/checkpoint.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/simulation.h"
#include "solvers/spring_chain.h"
#include "tests/scratch.h"

BOOST_AUTO_TEST_SUITE(own_methods)

using namespace springstab;
using Dense = Eigen::MatrixXd;

namespace {

/// u⁺ = u + hC(u + θ(u⁺ - u)) of x' = v, v' = -K'x - D'v: implicit Euler with θ = 1, the trapezoidal rule's
/// region with θ = ½.
struct Theta {
  double theta;

  MethodInfo info() const { return {"theta", "theta method", theta == 0.5 ? 2 : 1, true}; }
  template <class V>
  class Steps {
   public:
    explicit Steps(const Theta& method) : theta_(method.theta) {}
    template <Linearizable<V> System>
    StepStatus step(System& system, double h, State<V>& state) {
      const double part = theta_ * h;
      system.acceleration(state.x, state.v, a_);
      system.linearize(state.x, state.v, linear_);
      linear_->stiffness_times(state.v, v_);
      a_ = h * (a_ - part * v_);
      const SolveReport solved = linear_->solve_shifted({1, part, part * part}, a_, v_);
      if (solved.status != StepStatus::done) return solved.status;
      x_ = state.x + h * (state.v + theta_ * v_);
      v_ = state.v + v_;
      return commit(state, x_, v_);
    }

   private:
    double theta_;
    Linearization<V> linear_ = {};
    V x_, v_, a_;
  };
};

/// The same, of which no magnitude is known.
struct Bare : Theta {
  template <class V>
  struct Steps : Theta::Steps<V> {
    using Theta::Steps<V>::Steps;
    template <Linearizable<V> System>
    requires(!std::is_same_v<V, Magnitude>) StepStatus step(System& system, double h, State<V>& state) {
      return Theta::Steps<V>::step(system, h, state);
    }
  };
};

/// Of order 2 with two stages, as RK2, and so of the same stability function.
struct Ralston {
  MethodInfo info() const { return {"ralston", "Ralston", 2, false}; }
  template <class V>
  using Steps = ExplicitRungeKutta<V, ExplicitTableau<2>{.a = {{{}, {2. / 3}}}, .b = {0.25, 0.75}}>;
};

/// Velocity Verlet that carries the acceleration at the end of the step, damped as an explicit method can:
///     x⁺ = x + hv + ½h²a,  a⁺ = a(x⁺, v + ha),  v⁺ = v + ½h(a + a⁺).
struct CarriedVerlet {
  MethodInfo info() const {
    return {"carried-verlet", "velocity Verlet", 2, false, false, 1, StepChange::nothing};
  }
  template <class V>
  struct Steps {
    template <Accelerating<V> System>
    void start(System& system, double, State<V>& state) {
      system.acceleration(state.x, state.v, state.memory[0]);
    }
    template <Accelerating<V> System>
    StepStatus step(System& system, double h, State<V>& state) {
      carried.resize(1);
      x = state.x + h * state.v + (0.5 * h * h) * state.memory[0];
      v = state.v + h * state.memory[0];
      system.acceleration(x, v, carried[0]);
      v = state.v + (0.5 * h) * (state.memory[0] + carried[0]);
      return commit(state, x, v, carried);
    }
    V x, v;
    std::vector<V> carried;
  };
  // One step over (x, v, a) of x'' = -Kx - Dv.
  static Dense oracle(const Dense& k, const Dense& d, double h) {
    const Eigen::Index n = k.rows();
    const Dense one = Dense::Identity(n, n);
    Dense x(n, 3 * n), v(n, 3 * n), p(n, 3 * n), all(3 * n, 3 * n);
    x << one, h * one, 0.5 * h * h * one;
    p << 0 * one, one, h * one;
    const Dense a = -k * x - d * p;
    v << 0 * one, one, 0.5 * h * one;
    v += 0.5 * h * a;
    all << x, v, a;
    return all;
  }
};

/// Verlet's method in positions: x⁺ = 2x - x⁻ + h²a(x, v), v⁺ = (x⁺ - x)/h, which carries x⁻. With another
/// h it is x less the same velocity's way.
struct PositionVerlet {
  MethodInfo info() const { return {"position-verlet", "Verlet", 1, false, false, 1, StepChange::rescale}; }
  template <class V>
  struct Steps {
    template <Accelerating<V> System>
    void start(System&, double h, State<V>& state) {
      state.memory[0] = state.x - h * state.v;
    }
    template <Accelerating<V> System>
    StepStatus step(System& system, double h, State<V>& state) {
      before.resize(1);
      system.acceleration(state.x, state.v, a);
      x = state.x + (state.x - state.memory[0]) + (h * h) * a;
      v = (1 / h) * (x - state.x);
      before[0] = state.x;
      return commit(state, x, v, before);
    }
    template <class System>
    void change_step(System&, double h_old, double h_new, State<V>& state) {
      state.memory[0] = state.x - (h_new / h_old) * (state.x - state.memory[0]);
    }
    V x, v, a;
    std::vector<V> before;
  };
  static Dense oracle(const Dense& k, const Dense& d, double h) {
    const Eigen::Index n = k.rows();
    const Dense one = Dense::Identity(n, n);
    Dense x(n, 3 * n), before(n, 3 * n), all(3 * n, 3 * n);
    x << 2 * one - h * h * k, -h * h * d, -one;
    before << one, 0 * one, 0 * one;
    all << x, (x - before) / h, before;
    return all;
  }
};

SpringChain chain() { return SpringChain({1.3, 0.7, 2.1, 0.9, 1.1}, {40, 25, 60, 15, 35, 50}, {0.3, 0.004}); }

// D' and K' of the chain.
std::pair<Dense, Dense> matrices_of(SpringChain& system) {
  const Eigen::Index n = system.size();
  Dense k(n, n), d(n, n);
  Vector column;
  for (Eigen::Index j = 0; j < n; ++j) {
    system.stiffness_times(Vector::Unit(n, j), column), k.col(j) = column;
    system.damping_times(Vector::Unit(n, j), column), d.col(j) = column;
  }
  return {k, d};
}

State<Vector> plucked(Eigen::Index n) {
  State<Vector> state{Vector(n), Vector(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    state.x[i] = std::sin(1.7 * static_cast<double>(i) + 0.4);
    state.v[i] = std::cos(2.3 * static_cast<double>(i));
  }
  return state;
}

void check_same_bits(const State<Vector>& a, const State<Vector>& b) {
  BOOST_TEST((a.x == b.x && a.v == b.v));
  BOOST_REQUIRE(a.memory.size() == b.memory.size());
  for (std::size_t i = 0; i < a.memory.size(); ++i) BOOST_TEST((a.memory[i] == b.memory[i]));
}

const EnergyWatch asleep{.initial_energy = std::numeric_limits<double>::infinity()};

template <class Description>
void check_matrices(const Description& description) {
  const Method method = make_method(description);
  BOOST_TEST_CONTEXT(method.name()) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1, 4);
    const std::vector<RationalFunction> formula = method.symbolic_step();
    BOOST_REQUIRE(formula.size() == 9);
    std::vector<double> xs, ys;
    for (int i = 0; i < 100; ++i) {
      const double x = uniform(random), y = uniform(random);
      xs.push_back(x), ys.push_back(y);
      const Dense expected = Description::oracle(Dense::Constant(1, 1, y), Dense::Constant(1, 1, x), 1);
      const Dense a = method.amplification(x, y);
      BOOST_TEST((a - expected).norm() <= 1e-14 * expected.norm());
      for (Eigen::Index r = 0; r < 3; ++r)
        for (Eigen::Index c = 0; c < 3; ++c)
          BOOST_TEST(std::abs(formula[static_cast<std::size_t>(3 * r + c)](x, y) - expected(r, c)) <=
                     1e-13 * expected.norm());
      const std::optional<Dense> size = method.magnitude(Dense::Constant(1, 1, y), Dense::Constant(1, 1, x));
      BOOST_REQUIRE(size.has_value());
      BOOST_TEST((expected.cwiseAbs().array() <= size->array() * (1 + 1e-14)).all());
    }
    std::vector<double> radii(xs.size());
    std::vector<CellFate> fates(xs.size());
    spectral_radius(method, xs, ys, radii);
    simulate_cells(method, xs, ys, 3000, 1e6, fates);
    int decayed = 0, diverged = 0;
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const Dense expected =
          Description::oracle(Dense::Constant(1, 1, ys[i]), Dense::Constant(1, 1, xs[i]), 1);
      const double radius = expected.eigenvalues().cwiseAbs().maxCoeff();
      BOOST_TEST(std::abs(radii[i] - radius) <= 1e-7 * radius);
      BOOST_TEST((radius > 0.99 || fates[i] == CellFate::decayed));
      BOOST_TEST((radius < 1.01 || fates[i] == CellFate::diverged));
      decayed += radius < 0.99;
      diverged += radius > 1.01;
    }
    BOOST_TEST((decayed > 5 && diverged > 5));

    SpringChain system = chain();
    const auto [k, d] = matrices_of(system);
    const Dense transition = as_dense(transition_operator(system, method, 0.07));
    const Dense expected = Description::oracle(k, d, 0.07);
    BOOST_TEST((transition - expected).norm() <= 1e-13 * expected.norm());
  }
}

// A run that stops at a checkpoint, goes to disk and is taken up by other objects ends in the bits of one
// that did not stop; the oracle's power is where it ends.
template <class Description>
void check_resumed(const Description& description) {
  const Method method = make_method(description);
  const springstab::test::ScratchFolder folder;
  const double h = 0.05;
  SpringChain system = chain();
  State<Vector> whole = plucked(system.size()), part = whole, begin = whole;
  const StepPlan plan{h, 200};
  BOOST_TEST((simulate(system, *method.stepper(), plan, asleep, whole).status == StepStatus::done));

  CheckpointFile file(folder.path().string(), Json{{"method", method.name()}}, {}, true);
  simulate(system, *method.stepper(), plan, asleep, part, [&](const RunSoFar& run, const State<Vector>& s) {
    if (run.steps < 90 || !run.at_checkpoint) return true;
    file.save([&] { return KeptRun{run, s, {}}; });
    return false;
  });
  std::optional<KeptRun> kept = file.read();
  BOOST_REQUIRE(kept.has_value());
  BOOST_TEST(kept->state.memory.size() == 1);
  BOOST_TEST((kept->run.steps >= 90 && kept->run.steps < 200));
  SpringChain other = chain();
  resume_simulation(other, *method.stepper(), kept->run, asleep, kept->state);
  check_same_bits(kept->state, whole);

  method.stepper()->start(system, h, begin);
  const auto [k, d] = matrices_of(system);
  const Eigen::Index n = system.size();
  Vector w(3 * n);
  w << begin.x, begin.v, begin.memory[0];
  const Dense a = Description::oracle(k, d, h);
  for (int i = 0; i < 200; ++i) w = a * w;
  BOOST_TEST((w.head(n) - whole.x).norm() <= 1e-10 * begin.x.norm());
  BOOST_TEST((w.tail(n) - whole.memory[0]).norm() <= 1e-10 * begin.memory[0].norm());
}

/// A chain whose accelerations are NaN at one call.
class FailingChain final : public System {
 public:
  FailingChain(SpringChain chain, int failing_call) : chain_(std::move(chain)), failing_call_(failing_call) {}
  Eigen::Index size() const override { return chain_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override {
    chain_.acceleration(x, v, out);
    if (++calls_ == failing_call_) out[2] = std::numeric_limits<double>::quiet_NaN();
  }
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override {
    chain_.linearize(x, v, linear);
  }
  double kinetic_energy(const Vector& v) override { return chain_.kinetic_energy(v); }
  double potential_energy(const Vector& x) override { return chain_.potential_energy(x); }

 private:
  SpringChain chain_;
  int failing_call_, calls_ = 0;
};

// What is carried goes back with x and v to the checkpoint, and on to the new step.
template <class Description>
void check_rolled_back(const Description& description) {
  const Method method = make_method(description);
  const double h = 0.05, shorter = 0.02;
  FailingChain failing(chain(), 27);
  State<Vector> state = plucked(failing.size()), expected = state;
  long kept = 0;
  const SimulationResult result =
      simulate(failing, *method.stepper(), {h, 100}, asleep, state, {},
               [&](const SimulationResult& so_far, const State<Vector>&, const StepPlan&) {
                 kept = so_far.steps;
                 return std::optional<StepPlan>({shorter, 40});
               });
  BOOST_TEST((result.status == StepStatus::done && result.failures == 1));
  BOOST_TEST(kept == 16);
  SpringChain system = chain();
  const auto stepper = method.stepper();
  stepper->start(system, h, expected);
  for (long i = 0; i < kept; ++i) stepper->step(system, h, expected);
  stepper->change_step(system, h, shorter, expected);
  for (long i = 0; i < 40; ++i) stepper->step(system, shorter, expected);
  check_same_bits(state, expected);
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_method_with_memory_is_its_oracle_on_an_oscillator_and_on_a_chain) {
  check_matrices(CarriedVerlet());
  check_matrices(PositionVerlet());
}

BOOST_AUTO_TEST_CASE(a_run_with_memory_goes_on_to_the_same_bits) {
  check_resumed(CarriedVerlet());
  check_resumed(PositionVerlet());
}

BOOST_AUTO_TEST_CASE(memory_goes_back_to_the_checkpoint_and_on_to_the_new_step) {
  check_rolled_back(CarriedVerlet());
  check_rolled_back(PositionVerlet());
}

// Without the rescaling the same x and v would be another motion.
BOOST_AUTO_TEST_CASE(a_step_that_changes_keeps_the_velocity) {
  SpringChain system = chain();
  const auto stepper = make_method(PositionVerlet()).stepper();
  State<Vector> state = plucked(system.size());
  stepper->start(system, 0.05, state);
  for (int i = 0; i < 7; ++i) stepper->step(system, 0.05, state);
  stepper->change_step(system, 0.05, 0.02, state);
  BOOST_TEST(((state.x - state.memory[0]) / 0.02 - state.v).norm() <= 1e-12 * state.v.norm());
  BOOST_TEST((state.x - state.memory[0]).norm() > 0.001);
}

BOOST_AUTO_TEST_CASE(an_explicit_method_of_a_user_has_a_region_limits_and_simulations) {
  const Method ralston = make_method(Ralston());
  const StabilityRegion& region = stability_region(ralston);
  const RegionConstants &own = region.constants(), &known = stability_region("rk2").constants();
  BOOST_TEST(own.y_max == known.y_max, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(own.x_at_y_max == known.x_at_y_max, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(own.real_interval == known.real_interval, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(&stability_region(Method(ralston)) == &region);
  BOOST_TEST(inscribed_polygons(ralston).fit({{0.3, 2}}).h == inscribed_polygons("rk2").fit({{0.3, 2}}).h,
             boost::test_tools::tolerance(1e-4));

  SpringChain system = chain();
  StructuralMatrices s = system.matrices();
  const StiffestMode k0 = stiffest_mode(s);
  const MethodLimits limits = method_limits(ralston, k0, {DampingModel::Kind::rayleigh, 0.3, 0.004}, 1.5);
  const MethodLimits rk2 = method_limits("rk2", k0, {DampingModel::Kind::rayleigh, 0.3, 0.004}, 1.5);
  BOOST_REQUIRE((limits.h_max && rk2.h_max && limits.h_certified));
  BOOST_TEST(*limits.h_max == *rk2.h_max, boost::test_tools::tolerance(1e-9));
  const auto ends = [&](double h) {
    State<Vector> state = plucked(system.size());
    simulate(system, *ralston.stepper(), {h, 20000}, asleep, state);
    return state.x.norm();
  };
  BOOST_TEST(ends(0.99 * *limits.h_max) < 1e-2);
  BOOST_TEST(!(ends(1.01 * *limits.h_max) < 1e2));
}

BOOST_AUTO_TEST_CASE(methods_of_one_name_and_other_parameters_do_not_share) {
  const Method midpoint = make_method(Theta{0.5}), euler = make_method(Theta{1}),
               third = make_method(Theta{1. / 3});
  BOOST_TEST((midpoint.name() == euler.name() && !(midpoint == euler)));
  BOOST_TEST(stability_region(euler).same_conditions(stability_region("implicit-euler")));
  BOOST_TEST(!stability_region(midpoint).same_conditions(stability_region("implicit-euler")));
  BOOST_TEST(stability_region(midpoint).constants().covers_quadrant);
  // θ < ½ ends where |R| = 1 on the real axis: z = -2/(1 - 2θ)
  BOOST_TEST(stability_region(third).constants().real_interval == 6, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(&inscribed_polygons(midpoint) != &inscribed_polygons(euler));
  const Method bare = make_method(Bare{{0.5}});
  BOOST_TEST((euler.has_magnitude() && euler.magnitude(Dense::Ones(1, 1), Dense::Ones(1, 1))));
  BOOST_TEST((!bare.has_magnitude() && !bare.magnitude(Dense::Ones(1, 1), Dense::Ones(1, 1))));
  SpringChain system = chain();
  const Dense one = as_dense(transition_operator(system, euler, 0.3)),
              other = as_dense(transition_operator(system, "implicit-euler", 0.3));
  BOOST_TEST((one - other).norm() <= 1e-14 * one.norm());
  // the trapezoidal rule keeps the energy of an undamped chain
  system.set_damping({});
  State<Vector> state = plucked(system.size());
  const auto energy = [&] { return system.kinetic_energy(state.v) + system.potential_energy(state.x); };
  const double before = energy();
  simulate(system, *midpoint.stepper(), {0.5, 500}, asleep, state);
  BOOST_TEST(energy() == before, boost::test_tools::tolerance(1e-11));
}

BOOST_AUTO_TEST_CASE(where_there_is_no_magnitude_there_is_no_lyapunov_proof_and_that_is_said) {
  StructuralMatrices s = chain().matrices();
  SparseMatrix damper(s.size(), s.size());
  damper.insert(1, 1) = 3;
  s.damping = damper;
  const StiffestMode k0 = stiffest_mode(s);
  GeneralDamping limits(s, k0, classify_damping(s), 1.5, true);
  const MethodLimits none = limits.limits(make_method(Bare{{0.2}}));
  BOOST_TEST(!none.h_certified);
  BOOST_TEST(none.unproved.find("Lyapunov") != std::string_view::npos);
}

BOOST_AUTO_TEST_CASE(a_description_that_promises_what_its_steps_lack_is_refused) {
  struct Forgetful : Ralston {
    MethodInfo info() const { return {"forgetful", "forgetful", 2, false, false, 1}; }
  };
  struct Rigid : Ralston {
    MethodInfo info() const { return {"rigid", "rigid", 2, false, false, 0, StepChange::rescale}; }
  };
  BOOST_CHECK_THROW(make_method(Forgetful()), std::invalid_argument);
  BOOST_CHECK_THROW(make_method(Rigid()), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
