// The simulation loop: limits hold in real runs, divergence is caught and undone, energy behaves as it must,
// and what a run costs is what the methods say.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "analysis/limits/method_limits.h"
#include "analysis/method.h"
#include "experiments/runs/step_run.h"
#include "solvers/counting.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/triangle_cloth.h"
#include "solvers/simulation.h"
#include "tests/allocation_counter.h"
#include "tests/dense.h"

BOOST_AUTO_TEST_SUITE(simulation)

using namespace springstab;
using springstab::test::random_vector;

namespace {

using boost::test_tools::tolerance;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<int> first_row(int columns) {
  std::vector<int> row(columns);
  for (int j = 0; j < columns; ++j) row[j] = j;
  return row;
}

/// A cloth on an n x n grid, hung by its first row.
Scene cloth(int n, RayleighDamping damping = {}, double own_damping = 0) {
  SpringMaterial material;
  material.stiffness = {200, 100, 20};
  material.damping = {own_damping, own_damping, own_damping};
  return {make_net(Grid{n, n}, material), first_row(n), {0, -9.81, 0}, damping};
}

/// The linear system of the cloth a few percent stretched either way: K is positive definite then.
BlockLinearSystem stretched(Scene& scene, int columns) {
  State<Vector> state = scene.rest_state();
  for (Eigen::Index i = 0; i < state.x.size(); i += 3) state.x[i] *= 1.02, state.x[i + 2] *= 1.05;
  std::vector<Eigen::Vector3d> places = scene.positions(state.x);
  places.resize(columns);
  for (Eigen::Vector3d& p : places) p[0] *= 1.02;
  scene.place_pinned(places);
  return *scene.linearization(state);
}

StructuralMatrices matrices_of(const BlockLinearSystem& system) {
  return prepare(system.stiffness().to_sparse(), lumped_mass(system.mass()));
}

double energy(System& system, const State<Vector>& state) {
  return system.kinetic_energy(state.v) + system.potential_energy(state.x);
}

/// One unknown with x'' = -k x, times three.
BlockLinearSystem oscillator(double k) {
  BlockLinearSystem system({1.0}, {}, std::make_shared<BlockPattern>(1, Couplings()));
  const double none[3] = {0, 0, 0};
  add_isotropic_and_axial(system.stiffness().block(0), k, 0, none);
  return system;
}

State<Vector> displaced(Eigen::Index size) { return {Vector::Ones(size), Vector::Zero(size)}; }

constexpr EnergyWatch asleep{.initial_energy = 1, .slack = infinity};

/// Everything that a run showed.
struct Record {
  std::vector<SimulationResult> results;
  std::vector<State<Vector>> states;

  Observer observer(long stop_after = std::numeric_limits<long>::max()) {
    return [this, stop_after](const SimulationResult& result, const State<Vector>& state) {
      results.push_back(result);
      states.push_back(state);
      return result.steps < stop_after;
    };
  }
};

}  // namespace

// At 1.02 of the limit the slowest to grow is explicit Euler: |λ|² - 1 is about 0.02 Y, here 0.03.
BOOST_AUTO_TEST_CASE(the_linear_limit_of_a_cloth_parts_bounded_runs_from_diverging_ones,
                     *boost::unit_test::label("slow")) {
  const RayleighDamping damping{1, 3e-4};
  Scene scene = cloth(32, damping);
  BlockLinearSystem system = stretched(scene, 32);
  const StiffestMode k0 = stiffest_mode(matrices_of(system));
  BOOST_TEST((k0.converged && !k0.indefinite));
  const State<Vector> start{1e-3 * random_vector(system.size(), 1), Vector::Zero(system.size())};
  const EnergyWatch watch{.initial_energy = energy(system, start)};
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const MethodLimits limits =
          method_limits(method.name(), k0, {DampingModel::Kind::rayleigh, damping.d0, damping.alpha}, 1.5);
      if (method.info().implicit) {
        BOOST_TEST((limits.status == LimitStatus::unlimited));
        continue;
      }
      BOOST_TEST((limits.status == LimitStatus::limited));
      const auto stepper = method.stepper();
      State<Vector> state = start;
      const SimulationResult below =
          simulate(system, *stepper, {0.98 * *limits.h_max, 1000, 16}, watch, state);
      BOOST_TEST((below.status == StepStatus::done));
      BOOST_TEST(below.steps == 1000);
      BOOST_TEST(energy(system, state) < 0.5 * watch.initial_energy);

      state = start;
      const SimulationResult above =
          simulate(system, *stepper, {1.02 * *limits.h_max, 1500, 16}, watch, state);
      BOOST_TEST((above.status == StepStatus::diverged));
      BOOST_TEST(above.steps > 10);
      BOOST_TEST(energy(system, state) > 1e3 * watch.initial_energy);
    }
}

// With K and D positive semidefinite, backward Euler never raises the energy, at any step.
BOOST_AUTO_TEST_CASE(implicit_euler_stays_bounded_far_beyond_the_explicit_limits) {
  Scene scene = cloth(32, {}, 1e-4);
  BlockLinearSystem system = stretched(scene, 32);
  system.solver.tolerance = 1e-8;
  const double h = 100 * 2 / std::sqrt(stiffest_mode(matrices_of(system)).value);
  State<Vector> state{1e-3 * random_vector(system.size(), 2), random_vector(system.size(), 3)};
  const EnergyWatch watch{.initial_energy = energy(system, state), .slack = 1};
  double last = watch.initial_energy;
  const Observer observer = [&](const SimulationResult&, const State<Vector>& now) {
    const double e = energy(system, now);
    BOOST_TEST(e <= last * (1 + 1e-6));
    last = e;
    return true;
  };
  const auto stepper = Method("implicit-euler").stepper();
  const SimulationResult result = simulate(system, *stepper, {h, 40}, watch, state, observer);
  BOOST_TEST((result.status == StepStatus::done));
  BOOST_TEST(last < 0.1 * watch.initial_energy);
  BOOST_TEST(last > 0);
}

// Undamped drift-kick Euler conserves E + (h/2) xᵀKv exactly. At half its limit h√k <= 1 for every mode, so
// that E itself stays within a factor of (1 + ½)/(1 - ½) = 3.
BOOST_AUTO_TEST_CASE(symplectic_euler_conserves_its_own_energy_for_ten_thousand_steps,
                     *boost::unit_test::label("slow")) {
  Scene scene = cloth(12);
  BlockLinearSystem system = stretched(scene, 12);
  const double h = 1 / std::sqrt(stiffest_mode(matrices_of(system)).value);
  State<Vector> state{1e-3 * random_vector(system.size(), 4), random_vector(system.size(), 5)};
  const double start = energy(system, state);
  Vector force(system.size());
  const auto own_energy = [&](const State<Vector>& now) {
    system.stiffness().multiply(now.x.data(), force.data());
    return energy(system, now) + h / 2 * force.dot(now.v);
  };
  const double own_start = own_energy(state);
  double lowest = start, highest = start, drift = 0;
  const Observer observer = [&](const SimulationResult&, const State<Vector>& now) {
    const double e = energy(system, now);
    lowest = std::min(lowest, e);
    highest = std::max(highest, e);
    drift = std::max(drift, std::abs(own_energy(now) / own_start - 1));
    return true;
  };
  const auto stepper = Method("symplectic-euler").stepper();
  const SimulationResult result =
      simulate(system, *stepper, {h, 10'000}, {.initial_energy = 3 * start, .slack = 1}, state, observer);
  BOOST_TEST((result.status == StepStatus::done));
  BOOST_TEST(result.steps == 10'000);
  BOOST_TEST(drift < 1e-11);
  BOOST_TEST(highest <= 3 * lowest);
  BOOST_TEST(highest >= 1.001 * lowest);
}

BOOST_AUTO_TEST_CASE(the_observer_sees_every_state_from_the_first_on_and_can_stop) {
  BlockLinearSystem system = oscillator(4);
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const double h = 0.01;
      State<Vector> state = displaced(3), alone = state;
      Record record;
      const auto stepper = method.stepper();
      SimulationResult result = simulate(system, *stepper, {h, 7}, asleep, state, record.observer());
      BOOST_TEST((result.status == StepStatus::done));
      BOOST_REQUIRE_EQUAL(record.states.size(), 8U);
      for (long i = 0; i <= 7; ++i) {
        BOOST_TEST(record.results[i].steps == i);
        BOOST_TEST(record.results[i].time == static_cast<double>(i) * h, tolerance(1e-15));
        BOOST_TEST((record.states[i].x == alone.x && record.states[i].v == alone.v));
        BOOST_TEST((stepper->step(system, h, alone) == StepStatus::done));
      }
      BOOST_TEST((state.x == record.states[7].x && state.v == record.states[7].v));
      BOOST_TEST(result.time == 7 * h, tolerance(1e-15));

      Record stopped;
      state = displaced(3);
      result = simulate(system, *stepper, {h, 7}, asleep, state, stopped.observer(3));
      BOOST_TEST(result.steps == 3);
      BOOST_TEST((result.status == StepStatus::done));
      BOOST_TEST((state.x == record.states[3].x));
      result = simulate(system, *stepper, {h, 7}, asleep, state, stopped.observer(0));
      BOOST_TEST(result.steps == 0);
      result = simulate(system, *stepper, {h, 0}, asleep, state);
      BOOST_TEST((result.steps == 0 && result.time == 0));
      BOOST_TEST((state.x == record.states[3].x));
    }
}

BOOST_AUTO_TEST_CASE(a_run_that_diverges_ends_at_its_last_checkpoint) {
  BlockLinearSystem system = oscillator(4);
  const double h = 1.5;  // Y = 9: beyond every explicit method
  for (const double slack : {10.0, 1e3, infinity})
    for (const Method& method : all_methods()) {
      if (method.info().implicit) continue;
      BOOST_TEST_CONTEXT(method.name() << ", slack " << slack) {
        State<Vector> state = displaced(3);
        const EnergyWatch watch{.initial_energy = energy(system, state), .slack = slack};
        Record record;
        const SimulationResult result =
            simulate(system, *method.stepper(), {h, 100'000}, watch, state, record.observer());
        BOOST_TEST((result.status == StepStatus::diverged));
        const long good_steps = static_cast<long>(record.states.size()) - 1;
        BOOST_TEST(result.failed_at == h * static_cast<double>(good_steps + 1), tolerance(1e-14));
        BOOST_TEST(result.steps % 16 == 0);
        BOOST_TEST((result.steps <= good_steps && good_steps < result.steps + 16));
        BOOST_TEST(result.time == h * static_cast<double>(result.steps), tolerance(1e-14));
        const State<Vector>& kept = record.states[result.steps];
        BOOST_TEST((state.x == kept.x && state.v == kept.v));
        BOOST_TEST((state.x.allFinite() && state.v.allFinite()));
        for (const State<Vector>& good : record.states)
          BOOST_TEST(std::sqrt(system.kinetic_energy(good.v)) <= slack * std::sqrt(watch.initial_energy));
        State<Vector> next = record.states.back();
        const StepStatus status = method.stepper()->step(system, h, next);
        if (std::isfinite(slack)) {
          BOOST_TEST((status == StepStatus::done));
          BOOST_TEST(std::sqrt(system.kinetic_energy(next.v)) > slack * std::sqrt(watch.initial_energy));
        } else {
          BOOST_TEST((status == StepStatus::diverged || !std::isfinite(system.kinetic_energy(next.v))));
        }
      }
    }
}

BOOST_AUTO_TEST_CASE(a_solve_that_fails_ends_the_run_with_its_reason) {
  const auto stepper = Method("implicit-euler").stepper();
  BlockLinearSystem buckling = oscillator(-4);
  State<Vector> state = displaced(3);
  SimulationResult result = simulate(buckling, *stepper, {0.6, 5}, asleep, state);  // 1 - 4h² < 0
  BOOST_TEST((result.status == StepStatus::not_positive_definite));
  BOOST_TEST(result.steps == 0);
  BOOST_TEST((state.x == displaced(3).x));
  result = simulate(buckling, *stepper, {0.4, 5}, asleep, state);
  BOOST_TEST((result.status == StepStatus::done));

  Scene scene = cloth(5);
  scene.solver().max_iterations = 1;
  State<Vector> hanging = scene.rest_state();
  hanging.v.setOnes();
  const State<Vector> before = hanging;
  result = simulate(scene, *stepper, {0.01, 5}, asleep, hanging);
  BOOST_TEST((result.status == StepStatus::not_converged));
  BOOST_TEST((hanging.x == before.x && hanging.v == before.v));
}

BOOST_AUTO_TEST_CASE(a_failed_solve_is_planned_anew_from_where_it_failed) {
  BlockLinearSystem system = oscillator(-4);  // backward Euler needs h < 0.5
  State<Vector> state = displaced(3);
  Record record;
  int asked = 0;
  const StepPolicy policy = [&](const SimulationResult& so_far, const State<Vector>& good,
                                const StepPlan& failed) {
    ++asked;
    BOOST_TEST((so_far.status == StepStatus::not_positive_definite));
    BOOST_TEST(failed.h == 0.6);
    BOOST_TEST((good.x == state.x));
    return std::optional(StepPlan{0.2, 3});
  };
  const SimulationResult result = simulate(system, *Method("implicit-euler").stepper(), {0.6, 3}, asleep,
                                           state, record.observer(), policy);
  BOOST_TEST((result.status == StepStatus::done));
  BOOST_TEST(result.steps == 9);
  BOOST_TEST(result.failures == 3);
  BOOST_TEST(asked == result.failures);
  BOOST_TEST(result.time == 1.8, tolerance(1e-14));
  State<Vector> alone = displaced(3);
  simulate(system, *Method("implicit-euler").stepper(), {0.2, 9}, asleep, alone);
  BOOST_TEST((state.x == alone.x && state.v == alone.v));
  for (std::size_t i = 0; i < record.results.size(); ++i)
    BOOST_TEST(record.results[i].time == 0.2 * static_cast<double>(i), tolerance(1e-14));
}

// The whole of the rest is planned anew, from a checkpoint, and what happened since it leaves no trace.
BOOST_AUTO_TEST_CASE(a_divergence_is_undone_back_to_the_checkpoint) {
  BlockLinearSystem system = oscillator(4);
  for (const Method& method : all_methods()) {
    if (method.info().implicit) continue;
    BOOST_TEST_CONTEXT(method.name()) {
      const double bad = 1.45, good = 0.01;  // Y = 8.41, beyond every explicit method without damping
      State<Vector> state = displaced(3);
      const EnergyWatch watch{.initial_energy = energy(system, state), .slack = 1e8};
      Record record;
      State<Vector> at_checkpoint;
      const StepPolicy policy = [&](const SimulationResult& so_far, const State<Vector>& from,
                                    const StepPlan& failed) {
        BOOST_TEST((so_far.status == StepStatus::diverged));
        BOOST_TEST(failed.h == bad);
        BOOST_TEST((from.x == record.states[so_far.steps].x && from.v == record.states[so_far.steps].v));
        at_checkpoint = from;
        return std::optional(StepPlan{good, 25, 5});
      };
      const SimulationResult result =
          simulate(system, *method.stepper(), {bad, 10'000, 6}, watch, state, record.observer(), policy);
      BOOST_TEST((result.status == StepStatus::done));
      BOOST_TEST(result.failures == 1);
      const long kept = result.steps - 25;
      BOOST_TEST(kept % 18 == 0);  // three linearizations of six steps
      BOOST_TEST(static_cast<long>(record.states.size()) > kept + 26);
      BOOST_TEST(result.time == static_cast<double>(kept) * bad + 25 * good, tolerance(1e-13));
      simulate(system, *method.stepper(), {good, 25, 5}, asleep, at_checkpoint);
      BOOST_TEST((state.x == at_checkpoint.x && state.v == at_checkpoint.v));
    }
  }
}

// What an observer sees at a checkpoint is all that there is: from each of them another scene goes on to the
// same bits, also across divergences that are undone and steps that are halved.
BOOST_AUTO_TEST_CASE(a_run_goes_on_from_any_checkpoint_as_if_it_had_not_stopped,
                     *boost::unit_test::label("slow")) {
  constexpr double duration = 0.4;
  const StepPolicy shorter = [](const SimulationResult& so_far, const State<Vector>&,
                                const StepPlan& failed) {
    const bool diverged = so_far.status == StepStatus::diverged;
    const double h = failed.h / 2, rest = diverged ? duration - so_far.time : failed.h;
    const long each = failed.steps_per_linearization;
    return std::optional(StepPlan{h, std::lround(rest / h / static_cast<double>(each)) * each, each});
  };
  long failures = 0, resumed = 0;
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const double h = method.info().implicit ? 0.02 : 0.008;
      const StepPlan plan{h, std::lround(duration / h), method.info().linearized ? 5 : 1};
      Scene scene = cloth(5, {1, 1e-4});
      State<Vector> start = scene.rest_state();
      for (double& x : start.x) x *= 0.9;
      const EnergyWatch watch = {
          .initial_energy = energy(scene, start), .gravity = 9.81, .mass = 1, .slack = 10};
      std::vector<std::pair<RunSoFar, State<Vector>>> checkpoints;
      State<Vector> end = start;
      const SimulationResult whole = simulate(
          scene, *method.stepper(), plan, watch, end,
          [&](const RunSoFar& so_far, const State<Vector>& state) {
            if (so_far.at_checkpoint) checkpoints.emplace_back(so_far, state);
            return true;
          },
          shorter);
      BOOST_TEST((whole.status == StepStatus::done));
      failures += whole.failures;
      for (const auto& [run, state] : checkpoints) {
        Scene another = cloth(5, {1, 1e-4});
        State<Vector> s = state;
        const SimulationResult rest =
            resume_simulation(another, *method.stepper(), run, watch, s, {}, shorter);
        ++resumed;
        BOOST_TEST((s.x == end.x && s.v == end.v));
        BOOST_TEST((rest.steps == whole.steps && rest.time == whole.time && rest.failures == whole.failures));
      }
    }
  BOOST_TEST(failures > 5);
  BOOST_TEST(resumed > 100);
}

// A gain in total energy is seen while the speed is still plausible.
BOOST_AUTO_TEST_CASE(a_gain_of_energy_ends_a_run_at_a_checkpoint) {
  BlockLinearSystem system = oscillator(4);
  State<Vector> state = displaced(3);
  const double start = energy(system, state), h = 0.02;  // explicit Euler gains a factor of 1 + Y a step
  const EnergyWatch watch{.initial_energy = start, .slack = 1e6, .initial_total = start, .largest_gain = 1};
  const SimulationResult result =
      simulate(system, *Method("explicit-euler").stepper(), {h, 10'000}, watch, state);
  BOOST_TEST((result.status == StepStatus::diverged));
  const double growth = 1 + 4 * h * h;
  const long doubled = static_cast<long>(std::ceil(std::log(2) / std::log(growth) / 16)) * 16;
  BOOST_TEST(result.failed_at == static_cast<double>(doubled) * h, tolerance(1e-12));
  BOOST_TEST(result.steps == doubled - 16);
  BOOST_TEST(energy(system, state) == start * std::pow(growth, doubled - 16), tolerance(1e-10));
}

// From rest, √T = g √(m/2) t is attained in free fall: the watch must stand exactly there.
BOOST_AUTO_TEST_CASE(the_watch_stands_where_free_fall_gets) {
  SpringNet net;
  net.rest = {{0, 0, 0}, {1, 0, 0}};
  net.mass = {0.7, 0.2};
  const Eigen::Vector3d g(2, -9, 1);
  Scene scene(net, {}, g, {});
  EnergyWatch watch{.gravity = g.norm(), .mass = scene.total_free_mass()};
  BOOST_TEST(watch.mass == 0.9, tolerance(1e-15));
  const auto run = [&](double slack) {
    State<Vector> state = scene.rest_state();
    watch.slack = slack;
    return simulate(scene, *Method("rk4").stepper(), {0.01, 100}, watch, state).status;
  };
  BOOST_TEST((run(1 + 1e-12) == StepStatus::done));
  BOOST_TEST((run(1 - 1e-12) == StepStatus::diverged));
  watch.slack = 1;
  const double t = std::sqrt(2 / watch.mass) / watch.gravity;  // where T = 1 J in free fall
  BOOST_TEST((watch.diverged(1, 0.99 * t) && !watch.diverged(1, 1.01 * t)));
  BOOST_TEST(watch.diverged(std::nan(""), 1));
  BOOST_TEST(watch.diverged(infinity, 1));
}

// A falling, swinging, damped net, integrated accurately: never beyond the bound itself.
BOOST_AUTO_TEST_CASE(the_watch_never_fires_in_a_passive_motion) {
  for (const double own_damping : {0.0, 2e-3}) {
    Scene scene = cloth(5, {0.2, 0}, own_damping);
    State<Vector> state = scene.rest_state();
    state.v = 0.5 * random_vector(state.v.size(), 6);
    state.x *= 1.1;
    EnergyWatch watch{.initial_energy = scene.kinetic_energy(state.v) + scene.elastic_energy(state.x),
                      .gravity = scene.gravity().norm(),
                      .mass = scene.total_free_mass(),
                      .slack = 1};
    double nearest = 0;
    const Observer observer = [&](const SimulationResult& so_far, const State<Vector>& now) {
      const double bound =
          std::sqrt(watch.initial_energy) + watch.gravity * std::sqrt(watch.mass / 2) * so_far.time;
      nearest = std::max(nearest, std::sqrt(scene.kinetic_energy(now.v)) / bound);
      return true;
    };
    const SimulationResult result =
        simulate(scene, *Method("rk4").stepper(), {1e-4, 8000}, watch, state, observer);
    BOOST_TEST((result.status == StepStatus::done));
    BOOST_TEST(nearest < 1);
    BOOST_TEST(nearest > 0.4);
  }
}

// What a scene lacks is not there: a feature that is switched off costs no coupling, no matrix and no force.
BOOST_AUTO_TEST_CASE(a_scene_holds_only_what_it_has) {
  const Grid grid{9, 7};
  const ClothMaterial all{.stiffness = {1000, 900, 100, 1e-5}, .damping = {0.1, 0.1, 0.01, 1e-8}};
  const auto scene = [&](const ClothMaterial& material) {
    return Scene(make_cloth(grid, material), first_row(7), {0, -9.81, 0}, {});
  };
  const auto blocks = [](Scene& s) { return s.linearization(s.rest_state())->stiffness().blocks(); };
  ClothMaterial material = all;
  Scene full = scene(material);
  BOOST_TEST(full.terms().elastic.size() == 2u);
  BOOST_TEST(full.terms().damping.size() == 2u);
  material.damping = {};
  Scene undamped = scene(material);
  BOOST_TEST(undamped.terms().damping.empty());
  BOOST_TEST(!undamped.linearization(undamped.rest_state())->own_damping());
  BOOST_TEST(blocks(undamped) == blocks(full));
  material.stiffness.bending = 0;
  Scene limp = scene(material);
  BOOST_TEST(limp.terms().elastic.size() == 1u);
  // Of 8 x 7 free particles: the diagonals, and edges along rows, columns and one diagonal of each cell.
  BOOST_TEST(blocks(limp) == 56 + (8 * 6 + 7 * 7 + 7 * 6));
  // A hinge joins the two corners across an edge: along rows, columns, and across the cell's other diagonal.
  BOOST_TEST(blocks(undamped) > blocks(limp) + 7 * 6);
}

// At Y = 4/1.5 symplectic Euler's energy norm may grow √((1 + √Y/2)/(1 - √Y/2)) = 3.15-fold, which is no
// divergence.
BOOST_AUTO_TEST_CASE(a_linear_system_does_not_diverge_at_its_recommended_step) {
  for (const double ratio : {0.02, 0.5, 0.9, 1.0}) {
    SparseMatrix stiffness(2, 2);
    stiffness.insert(0, 0) = 100;
    stiffness.insert(1, 1) = 100 * ratio;
    Model model(std::make_unique<MatrixSystem>(prepare(stiffness)));
    for (const char* name : {"rk4", "implicit-euler", "symplectic-euler", "linearized-rk4"})
      BOOST_TEST_CONTEXT(name << ", softer by " << ratio) {
        StepChooser chooser(model, {.method = name, .duration = 30, .max_step = 0.1});
        const StepPlan plan = chooser.first_plan().value();
        State<Vector> state = model.initial_state();
        const SimulationResult result = simulate(model.system(), *chooser.method().stepper(), plan,
                                                 chooser.watch(state), state, {}, chooser.policy());
        BOOST_TEST((result.status == StepStatus::done));
        BOOST_TEST(result.steps == plan.steps);
      }
  }
}

BOOST_AUTO_TEST_CASE(the_watch_allows_for_what_stable_steps_may_grow) {
  BOOST_TEST(tightened({}, 1).slack == 3);
  BOOST_TEST(tightened({}, 5).slack == 5);
  BOOST_TEST(tightened({}, 1e9).slack == EnergyWatch{}.slack);
  SceneDescription description;
  description.geometry = Grid{6, 6};
  description.pins.kind = Pins::Kind::first_row;
  Subject subject(description);
  SimulateOptions options;
  options.method = "symplectic-euler";
  options.duration = 100;  // the step is hardly shortened to end there
  const CommonOptions common;
  StepChooser chooser(subject, step_options(common, options));
  chooser.first_plan().value();
  const double half = std::sqrt(4 / 1.5) / 2;
  BOOST_TEST(chooser.watch(subject.initial_state(1)).slack == std::sqrt((1 + half) / (1 - half)),
             tolerance(2e-3));
}

// Neither gravity nor a start in motion: all there is is rounding, which has no energy to compare with.
BOOST_AUTO_TEST_CASE(rounding_at_rest_is_no_divergence) {
  for (const Material& material : {Material(SpringMaterial{}), Material(ClothMaterial{})})
    for (const double spacing : {0.1, 1e3})
      for (const Method& method : all_methods()) {
        SceneDescription description;
        description.geometry = Grid{5, 4, spacing};
        description.material = material;
        description.pins.kind = Pins::Kind::first_row;
        description.gravity.setZero();
        description.damping = {.d0 = 1, .alpha = std::nullopt};
        Subject subject(description);
        SimulateOptions options;
        options.method = method.name();
        options.duration = 0.5;
        const CommonOptions common;
        StepChooser chooser(subject, step_options(common, options));
        const StepPlan plan = chooser.first_plan().value();
        const State<Vector> start = subject.initial_state(1);
        State<Vector> state = start;
        const SimulationResult result = simulate(subject.system(), *method.stepper(), plan,
                                                 chooser.watch(start), state, {}, chooser.policy());
        BOOST_TEST_CONTEXT(method.name() << ", material " << material.index() << ", spacing " << spacing) {
          BOOST_TEST((result.status == StepStatus::done));
          BOOST_TEST(result.failures == 0);
          BOOST_TEST((state.x - start.x).cwiseAbs().maxCoeff() < 1e-9 * spacing);
        }
      }
}

// A limp sheet that is let go compresses; its exact K is indefinite there, and explicit Euler over forces
// frozen for 0.01 s goes wrong. Undone and linearized more often, the run ends where RK4's ends.
BOOST_AUTO_TEST_CASE(a_linearized_run_that_goes_wrong_is_undone_and_saved) {
  SceneDescription description;
  description.geometry = Grid{16, 16};
  description.material = ClothMaterial{.particle_mass = 1.25e-4};
  description.pins.kind = Pins::Kind::first_row;
  description.damping = {.d0 = 10, .alpha = std::nullopt};
  const CommonOptions common;
  const auto run = [&](const std::string& method, std::optional<double> step, long& rollbacks) {
    Subject subject(description);
    SimulateOptions options;
    options.method = method;
    options.duration = 0.5;
    options.step = step;
    StepChooser chooser(subject, step_options(common, options));
    const StepPlan plan = chooser.first_plan().value();
    State<Vector> state = subject.initial_state(1);
    const EnergyWatch watch = chooser.watch(state);
    double last_time = 0, fastest = 0;
    const Observer observer = [&](const SimulationResult& so_far, const State<Vector>& now) {
      last_time = so_far.time;
      fastest = std::max(fastest, std::sqrt(subject.system().kinetic_energy(now.v)));
      return true;
    };
    const SimulationResult result =
        simulate(subject.system(), *Method(method).stepper(), plan, watch, state, observer, chooser.policy());
    rollbacks = chooser.decisions().rollbacks;
    BOOST_TEST((result.status == (step ? StepStatus::diverged : StepStatus::done)));
    if (!step) BOOST_TEST(last_time == 0.5, tolerance(1e-9));
    BOOST_TEST(result.failures == rollbacks);
    BOOST_TEST((state.x.allFinite() && state.v.allFinite()));
    return subject.scene()->positions(state.x).back();
  };
  long saved = 0, none = 0;
  const Eigen::Vector3d end = run("linearized-explicit-euler", std::nullopt, saved);
  BOOST_TEST(saved >= 1);
  const Eigen::Vector3d reference = run("rk4", std::nullopt, none);
  BOOST_TEST(none == 0);
  BOOST_TEST((end - reference).norm() < 0.02);  // of a fall of 0.3 m
  BOOST_TEST((end - reference).norm() > 1e-6);
  // A step that the user insists on is not replaced: the run gives up.
  run("linearized-explicit-euler", 2.6e-4, none);
  BOOST_TEST(none == 0);
}

// The cost of a step: forces, assemblies, and products with K where the linear system is used.
BOOST_AUTO_TEST_CASE(a_step_costs_what_its_method_says) {
  const std::map<std::string, Counts> known{
      {"explicit-euler", {1, 0, 0, 0}},
      {"rk2", {2, 0, 0, 0}},
      {"rk4", {4, 0, 0, 0}},
      {"symplectic-euler", {1, 0, 0, 0}},
      {"implicit-euler", {1, 1, 1, 0}},  // besides the iterations
      {"linearized-explicit-euler", {1, 1, 2, 0}},
      {"linearized-rk4", {1, 1, 5, 0}},
  };
  for (const double own_damping : {0.0, 1e-4})
    for (const Method& method : all_methods())
      BOOST_TEST_CONTEXT(method.name() << ", own damping " << own_damping) {
        const auto cost = known.find(std::string(method.name()));
        BOOST_REQUIRE(cost != known.end());
        Scene scene = cloth(6, {1, 1e-4}, own_damping);
        State<Vector> state = scene.rest_state(), alone = state;
        CountingSystem counting(scene);
        constexpr long steps = 5;
        const SimulationResult result = simulate(counting, *method.stepper(), {1e-4, steps}, asleep, state);
        BOOST_TEST((result.status == StepStatus::done));
        const Counts& counts = counting.counts();
        BOOST_TEST(counts.force_evaluations == steps * cost->second.force_evaluations);
        BOOST_TEST(counts.hessian_assemblies == steps * cost->second.hessian_assemblies);
        BOOST_TEST((counts.cg_iterations > 0) == method.info().implicit);
        if (own_damping == 0 || method.info().implicit)  // an iteration multiplies by the sum of all matrices
          BOOST_TEST(counts.block_products == steps * cost->second.block_products + counts.cg_iterations);

        simulate(scene, *method.stepper(), {1e-4, steps}, asleep, alone);
        BOOST_TEST((state.x == alone.x && state.v == alone.v));
        BOOST_TEST((state.x != scene.rest_state().x));
        BOOST_TEST(counting.size() == scene.size());
        BOOST_TEST(energy(counting, state) == energy(scene, state));
      }
}

// What is left of the difference is the tolerance of the conjugate gradients.
BOOST_AUTO_TEST_CASE(a_factorization_takes_the_steps_of_conjugate_gradients) {
  for (const double own_damping : {0.0, 1e-4}) {
    Scene scene = cloth(8, {1, 1e-3}, own_damping);
    CountingSystem iterated(scene), factorized(scene);
    State<Vector> by_iteration = scene.rest_state(), by_factorization = by_iteration;
    constexpr long steps = 20;
    scene.solver().tolerance = 1e-12;
    simulate(iterated, *Method("implicit-euler").stepper(), {0.01, steps}, asleep, by_iteration);
    scene.solver().kind = SolverKind::cholesky;
    const SimulationResult result =
        simulate(factorized, *Method("implicit-euler").stepper(), {0.01, steps}, asleep, by_factorization);
    BOOST_TEST((result.status == StepStatus::done));
    BOOST_TEST((by_factorization.x - by_iteration.x).norm() <= 1e-9 * by_iteration.x.norm());
    BOOST_TEST((by_iteration.x - scene.rest_state().x).norm() > 0.01);
    BOOST_TEST(iterated.counts().cg_iterations > steps);
    BOOST_TEST(factorized.counts().cg_iterations == 0);
    BOOST_TEST(factorized.counts().block_products == steps);
    BOOST_TEST(factorized.counts().hessian_assemblies == steps);
  }
}

// Springs pressed to half their length push their ends aside.
BOOST_AUTO_TEST_CASE(a_factorization_refuses_a_compressed_net_at_a_long_step) {
  Scene scene = cloth(6, {0, 0}, 0);
  State<Vector> state = scene.rest_state();
  state.x *= 0.5;
  const State<Vector> before = state;
  for (const SolverKind kind : {SolverKind::conjugate_gradients, SolverKind::cholesky}) {
    scene.solver().kind = kind;
    const auto stepper = Method("implicit-euler").stepper();
    BOOST_TEST((stepper->step(scene, 0.1, state) == StepStatus::not_positive_definite));
    BOOST_TEST((state.x == before.x && state.v == before.v));
    State<Vector> shorter = before;
    BOOST_TEST((stepper->step(scene, 1e-5, shorter) == StepStatus::done));
  }
}

BOOST_AUTO_TEST_CASE(nothing_is_allocated_after_the_first_step) {
  for (const double own_damping : {0.0, 1e-4})
    for (const Method& method : all_methods())
      for (const SolverKind solver : {SolverKind::conjugate_gradients, SolverKind::cholesky})
        BOOST_TEST_CONTEXT(method.name() << ", own damping " << own_damping) {
          if (solver == SolverKind::cholesky && !method.info().implicit) continue;
          Scene scene = cloth(6, {1, 1e-4}, own_damping);
          scene.solver().kind = solver;
          State<Vector> state = scene.rest_state();
          const auto stepper = method.stepper();
          long after_first = 0, at_last = 0;
          const Observer observer = [&](const SimulationResult& so_far, const State<Vector>&) {
            (so_far.steps <= 1 ? after_first : at_last) = allocations();
            return true;
          };
          const long before = allocations();
          simulate(scene, *stepper, {1e-4, 20}, asleep, state, observer);
          BOOST_TEST(at_last == after_first);
          BOOST_TEST(after_first > before, "the counter does not count");
        }
}

// Theory of the two methods on a cloth with frozen K: explicit Euler's damping hK turns drift-kick.
BOOST_AUTO_TEST_CASE(explicit_euler_with_alpha_h_takes_symplectic_eulers_steps_on_a_frozen_cloth) {
  const double h = 4e-4;
  Scene damped = cloth(7, {0.7, h}), plain = cloth(7, {0.7, 0});
  BlockLinearSystem a = stretched(damped, 7);
  BlockLinearSystem b = stretched(plain, 7);
  State<Vector> one{1e-3 * random_vector(a.size(), 1), random_vector(a.size(), 2)}, other = one;
  const auto explicit_euler = Method("explicit-euler").stepper(),
             symplectic_euler = Method("symplectic-euler").stepper();
  for (int i = 0; i < 100; ++i) {
    BOOST_REQUIRE((explicit_euler->step(a, h, one) == StepStatus::done));
    BOOST_REQUIRE((symplectic_euler->step(b, h, other) == StepStatus::done));
  }
  BOOST_TEST((one.x - other.x).norm() < 1e-11 * other.x.norm());
  BOOST_TEST((one.v - other.v).norm() < 1e-11 * other.v.norm());
  BOOST_TEST(other.v.norm() > 0.1);
}

// On a linear system there is nothing to freeze; on a cloth the difference is of the second order in the time
// that a linearization lasts.
BOOST_AUTO_TEST_CASE(a_linearized_method_is_the_one_inside_where_forces_are_linear) {
  const std::map<std::string, std::string> inside{{"linearized-explicit-euler", "explicit-euler"},
                                                  {"linearized-rk4", "rk4"}};
  for (const auto& [linearized, plain] : inside) {
    Scene scene = cloth(6, {1, 1e-4});
    BlockLinearSystem linear = stretched(scene, 6);
    State<Vector> one{1e-3 * random_vector(linear.size(), 3), random_vector(linear.size(), 4)}, other = one;
    const auto frozen = Method(linearized).stepper(), free = Method(plain).stepper();
    const auto run = [&](System& system, double h, int steps) {
      frozen->restart(7);
      for (int i = 0; i < steps; ++i) {
        BOOST_REQUIRE((frozen->step(system, h, one) == StepStatus::done));
        BOOST_REQUIRE((free->step(system, h, other) == StepStatus::done));
      }
      return (one.x - other.x).norm();
    };
    BOOST_TEST(run(linear, 1e-4, 30) < 1e-11 * other.x.norm());

    const State<Vector> rest = scene.rest_state();
    double apart[2];
    for (const int halved : {0, 1}) {
      one = other = {rest.x + 1e-3 * random_vector(rest.x.size(), 5), rest.v};
      apart[halved] = run(scene, halved ? 5e-5 : 1e-4, 7);  // one linearization
    }
    // From rest x moves like t² and v like t, so alpha K(x) v is wrong by t³ and the spring force by t⁴;
    // twice integrated, the positions part like t⁵ to t⁶.
    BOOST_TEST(apart[0] / apart[1] > 24);
    BOOST_TEST(apart[0] / apart[1] < 72);
  }
}

BOOST_AUTO_TEST_SUITE_END()
