// Steps of linearized methods that go through K together, in one pass over its rows: the same bits as one by
// one, whatever is asked of the run.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "solvers/counting.h"
#include "solvers/linear/wavefront.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/triangle_cloth.h"
#include "solvers/simulation.h"
#include "solvers/step_by_rows.h"
#include "solvers/team.h"
#include "tests/dense.h"
#include "tests/loop_threads.h"

BOOST_AUTO_TEST_SUITE(together)

using namespace springstab;
using springstab::test::LoopThreads;
using springstab::test::random_vector;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr const char* methods[] = {"linearized-explicit-euler", "linearized-rk4"};

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;
}

bool same_bits(const State<Vector>& a, const State<Vector>& b) {
  return same_bits(a.x, b.x) && same_bits(a.v, b.v);
}

struct Case {
  Grid grid;
  RayleighDamping damping;
  double own_damping = 0;
  bool triangles = false;
};

/// Smaller than a block of rows, of several blocks, with a bandwidth of most of the rows, and of so many rows
/// that threads share them.
const std::vector<Case> cases{{{.rows = 7, .columns = 5}, {0.7, 1e-4}},
                              {{.rows = 33, .columns = 29}, {0.7, 2e-4}},
                              {{.rows = 33, .columns = 29}, {0.7, 0}},
                              {{.rows = 61, .columns = 17}, {0.3, 1e-4}, 3e-4},
                              {{.rows = 5, .columns = 211}, {0, 1e-4}, 2e-4},
                              {{.rows = 301, .columns = 11}, {0.5, 1e-4}},
                              {{.rows = 43, .columns = 23}, {0.7, 1e-4}, 0, true}};

Scene scene_of(const Case& c) {
  const std::vector<int> pinned{0, c.grid.columns - 1};
  if (c.triangles)
    return {make_cloth(c.grid, {.particle_mass = 1e-3, .stiffness = {100, 100, 10, 1e-6}}),
            pinned,
            {0.3, -9.81, 0.1},
            c.damping};
  SpringMaterial material;
  material.stiffness = {200, 100, 20};
  material.damping = {c.own_damping, c.own_damping, c.own_damping};
  return {make_net(c.grid, material), pinned, {0.3, -9.81, 0.1}, c.damping};
}

State<Vector> start_of(const Scene& scene) {
  State<Vector> state = scene.rest_state();
  state.x += 1e-4 * random_vector(state.x.size(), 1);
  state.v = 0.1 * random_vector(state.v.size(), 2);
  return state;
}

EnergyWatch watch_of(Scene& scene, const State<Vector>& start) {
  return {.initial_energy = scene.kinetic_energy(start.v) + scene.elastic_energy(start.x),
          .gravity = scene.gravity().norm(),
          .mass = scene.total_free_mass()};
}

/// What a run leaves and shows.
struct Run {
  SimulationResult result;
  State<Vector> end;
  Counts counts;
  std::vector<RunSoFar> seen;
  std::vector<State<Vector>> states;  // likewise
};

struct Asked {
  StepPlan plan;
  EnergyWatch watch;
  StepPolicy policy{};
  UnseenUntil unseen_until{};
  bool keep_states = true;
};

Run run_of(const Case& c, const char* method, const Asked& asked) {
  Scene scene = scene_of(c);
  CountingSystem counted(scene);
  Run run{.result = {}, .end = start_of(scene), .counts = {}, .seen = {}, .states = {}};
  run.result = simulate(
      counted, *Method(method).stepper(), asked.plan, asked.watch, run.end,
      [&](const RunSoFar& so_far, const State<Vector>& state) {
        run.seen.push_back(so_far);
        if (asked.keep_states) run.states.push_back(state);
        return true;
      },
      asked.policy, nullptr, asked.unseen_until);
  run.counts = counted.counts();
  return run;
}

void expect_same(const Run& a, const Run& b) {
  BOOST_TEST(same_bits(a.end, b.end));
  BOOST_TEST((a.result.status == b.result.status));
  BOOST_TEST(a.result.steps == b.result.steps);
  BOOST_TEST(a.result.time == b.result.time);
  BOOST_TEST(a.result.failed_at == b.result.failed_at);
  BOOST_TEST(a.result.failures == b.result.failures);
  BOOST_TEST(a.counts.force_evaluations == b.counts.force_evaluations);
  BOOST_TEST(a.counts.hessian_assemblies == b.counts.hessian_assemblies);
  BOOST_TEST(a.counts.block_products == b.counts.block_products);
}

const UnseenUntil always = [] { return infinity; };

// Halves the step, for the rest of `duration`.
StepPolicy halving(double duration) {
  return [duration](const SimulationResult& so_far, const State<Vector>&, const StepPlan& failed) {
    const double h = failed.h / 2;
    return std::optional(
        StepPlan{h, std::lround((duration - so_far.time) / h), failed.steps_per_linearization});
  };
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_pass_is_behind_the_one_before_it_and_no_row_is_left_out) {
  for (const long rows : {1L, 7L, 256L, 257L, 3001L})
    for (const long bandwidth : {0L, 1L, 30L, 511L, 700L, 3000L})
      for (const long passes : {1L, 2L, 5L, 17L}) {
        const Wavefront wavefront(rows, bandwidth);
        std::vector<IndexRange> at(passes, {rows, rows});  // what each did last
        std::vector<long> done;
        wavefront.go(
            passes,
            [&](long pass, const IndexRange& range) {
              BOOST_REQUIRE(range.last == at[pass].first);
              BOOST_REQUIRE((0 <= range.first && range.first < range.last));
              at[pass] = range;
              if (pass == 0) return;
              const IndexRange& before = at[pass - 1];
              const long apart = range.first - wavefront.rows_apart();
              BOOST_REQUIRE(before.first == std::max(apart, 0L));
              if (before.first == apart)  // at the same time
                BOOST_REQUIRE(before.last + bandwidth < range.first);
            },
            [&](long pass) {
              BOOST_REQUIRE(at[pass].first == 0);
              done.push_back(pass);
            });
        BOOST_REQUIRE(static_cast<long>(done.size()) == passes);
        for (long pass = 0; pass < passes; ++pass) BOOST_REQUIRE(done[pass] == pass);
      }
}

BOOST_AUTO_TEST_CASE(steps_together_are_steps_one_by_one) {
  for (const char* method : methods)
    for (const Case& c : cases) {
      Scene scene = scene_of(c);
      const Asked asked{{1e-4, 83, 17},
                        watch_of(scene, start_of(scene))};  // the last linearization serves 15
      const Run alone = run_of(c, method, asked);
      BOOST_TEST((alone.result.status == StepStatus::done));
      BOOST_TEST(alone.seen.size() == 84U);
      BOOST_TEST(!same_bits(alone.end, start_of(scene)));
      for (const int threads : {1, 2, 3})
        BOOST_TEST_CONTEXT(method << ", " << c.grid.rows << " x " << c.grid.columns << ", " << threads
                                  << " threads") {
          const LoopThreads several(threads);
          Asked unseen = asked;
          unseen.unseen_until = always;
          const Run together = run_of(c, method, unseen);
          expect_same(alone, together);
          BOOST_TEST(together.seen.size() < 84U / 3);
          for (std::size_t i = 0; i < together.seen.size(); ++i)
            BOOST_TEST(same_bits(together.states[i], alone.states[together.seen[i].steps]));
        }
    }
}

BOOST_AUTO_TEST_CASE(what_a_run_shows_is_what_was_asked_for) {
  const Case& c = cases[1];
  Scene scene = scene_of(c);
  Asked asked{{1e-4, 100, 20}, watch_of(scene, start_of(scene))};
  const Run alone = run_of(c, methods[0], asked);
  const double due[] = {0.00031, 0.00115, 0.00121, 0.00765};
  std::size_t next = 0;
  asked.unseen_until = [&] { return next < std::size(due) ? due[next] : infinity; };
  std::set<long> seen;
  State<Vector> end = start_of(scene);
  simulate(
      scene, *Method(methods[0]).stepper(), asked.plan, asked.watch, end,
      [&](const RunSoFar& run, const State<Vector>& state) {
        while (next < std::size(due) && run.time >= due[next]) ++next;
        seen.insert(run.steps);
        BOOST_TEST(run.time == alone.seen[run.steps].time);
        BOOST_TEST(run.at_checkpoint == alone.seen[run.steps].at_checkpoint);
        BOOST_TEST(same_bits(state, alone.states[run.steps]));
        return true;
      },
      {}, nullptr, asked.unseen_until);
  for (const long step : {0, 4, 12, 13, 20, 40, 60, 77, 80, 100}) BOOST_TEST(seen.contains(step), step);
  BOOST_TEST(seen.size() < 20U);
}

BOOST_AUTO_TEST_CASE(a_run_together_goes_on_from_any_checkpoint) {
  long resumed = 0;
  for (const char* method : methods)
    for (const Case& c : {cases[1], cases[3]}) {
      Scene scene = scene_of(c);
      const Asked asked{{1e-4, 87, 13}, watch_of(scene, start_of(scene)), {}, always};
      const Run whole = run_of(c, method, asked);
      for (std::size_t i = 0; i < whole.seen.size(); ++i) {
        if (!whole.seen[i].at_checkpoint) continue;
        for (const bool together : {false, true}) {
          State<Vector> state = whole.states[i];
          Scene another = scene_of(c);
          const SimulationResult rest = resume_simulation(
              another, *Method(method).stepper(), whole.seen[i], asked.watch, state,
              [](const RunSoFar&, const State<Vector>&) { return true; }, {}, nullptr,
              together ? always : UnseenUntil());
          BOOST_TEST(same_bits(state, whole.end));
          BOOST_TEST(rest.steps == whole.result.steps);
          BOOST_TEST(rest.time == whole.result.time);
        }
        ++resumed;
      }
    }
  BOOST_TEST(resumed > 12);
}

// Too long a step, watched more and less closely, so that runs end at many places of a pass; by infinite
// numbers where nothing is too fast.
BOOST_AUTO_TEST_CASE(a_divergence_on_the_way_is_told_of_the_same_step) {
  const std::pair<const char*, double> too_long[] = {{methods[0], 1.6e-2}, {methods[1], 2.4e-2}};
  std::set<long> places;
  for (const auto& [method, h] : too_long)
    for (const double slack : {3., 10., 1e2, 1e4, 1e7, 1e11, infinity})
      for (const int threads : {1, 2}) BOOST_TEST_CONTEXT(method << ", slack " << slack) {
          const LoopThreads several(threads);
          const Case& c = cases[1];
          Scene scene = scene_of(c);
          Asked asked{{h, 4000, 19}, watch_of(scene, start_of(scene))};
          asked.watch.slack = slack;
          asked.keep_states = false;
          const Run alone = run_of(c, method, asked);
          asked.unseen_until = always;
          const Run together = run_of(c, method, asked);
          BOOST_TEST((alone.result.status == StepStatus::diverged));
          expect_same(alone, together);
          places.insert(std::lround(alone.result.failed_at / h) % 19);
        }
  BOOST_TEST(places.size() > 4U);
}

BOOST_AUTO_TEST_CASE(a_run_that_is_undone_and_saved_ends_alike, *boost::unit_test::label("slow")) {
  const std::pair<const char*, double> too_long[] = {{methods[0], 3.2e-3}, {methods[1], 6.4e-3}};
  for (const auto& [method, h] : too_long)
    for (const Case& c : {cases[1], cases[4]}) {
      Scene scene = scene_of(c);
      Asked asked{{h, 60, 10}, watch_of(scene, start_of(scene)), halving(60 * h)};
      asked.watch.slack = 30;
      asked.keep_states = false;
      const Run alone = run_of(c, method, asked);
      asked.unseen_until = always;
      const Run together = run_of(c, method, asked);
      BOOST_TEST((alone.result.status == StepStatus::done));
      BOOST_TEST(alone.result.failures > 1);
      expect_same(alone, together);
      // The first state after a divergence is seen: whoever keeps states takes later ones back then.
      long undone = 0;
      for (std::size_t i = 1; i < together.seen.size(); ++i)
        if (together.seen[i].failures > together.seen[i - 1].failures) {
          ++undone;
          BOOST_TEST(together.seen[i].stages.back().done == 1);
        }
      BOOST_TEST(undone > 0);
    }
}

// Whoever wants them one by one, or has only one, gets none.
BOOST_AUTO_TEST_CASE(a_stepper_takes_as_many_as_its_linearization_serves) {
  Scene scene = scene_of(cases[1]);
  const Plausible anything = [](long, double) { return true; };
  for (const char* method : methods) {
    const auto stepper = Method(method).stepper();
    State<Vector> state = start_of(scene);
    const State<Vector> start = state;
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 10, state, anything) == 0);  // one step a linearization
    stepper->restart(7);
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 1, state, anything) == 0);
    BOOST_TEST(same_bits(state, start));
    std::vector<double> kinetic;
    const Plausible up_to_third = [&](long step, double energy) {
      BOOST_TEST(step == static_cast<long>(kinetic.size()) + 1);
      kinetic.push_back(energy);
      return step < 3;
    };
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 7, state, up_to_third) == 0);
    BOOST_TEST(same_bits(state, start));
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 10, state, anything) == 7);
    BOOST_TEST((stepper->step(scene, 1e-4, state) == StepStatus::done));
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 10, state, anything) == 6);
    State<Vector> alone = start;
    stepper->restart(7);
    for (std::size_t i = 0; i < kinetic.size(); ++i) {
      stepper->step(scene, 1e-4, alone);
      BOOST_TEST(kinetic[i] == scene.kinetic_energy(alone.v), boost::test_tools::tolerance(1e-12));
    }
  }
  for (const char* method : {"rk4", "implicit-euler", "symplectic-euler"}) {
    State<Vector> state = start_of(scene);
    const auto stepper = Method(method).stepper();
    stepper->restart(7);
    BOOST_TEST(stepper->take_steps(scene, 1e-4, 7, state, anything) == 0);
    BOOST_TEST(same_bits(state, start_of(scene)));
  }
}

BOOST_AUTO_TEST_SUITE_END()
