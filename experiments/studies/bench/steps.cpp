// What a method's step costs beside a loop written by hand for the same net: the same forces,
// linearizations and solves, and one pass over the vectors for each line of the method. Both run in turn; the
// counter of_hand_loop is the median of the ratios of neighbouring pairs.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "experiments/studies/bench/measure.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab::bench::steps {
namespace {

constexpr double h = 1e-4;  // [s], stable under each of them

struct Hand {
  Hand(Scene& net, const State<Vector>& start) : scene(net), x(start.x), v(start.v) {}

  Scene& scene;
  Vector x, v, a, b, c, d, y, w;
  Vector x_before, v_before;  // BDF2's
  std::shared_ptr<LinearSystem> linear{};
};

void solve(Hand& s, double g, const Vector& right, Vector& out) {
  if (s.linear->solve_shifted({1, g, g * g}, right, out).status != StepStatus::done)
    throw std::runtime_error("the solve of a benchmark failed");
}

void symplectic_euler(Hand& s) {
  s.x += h * s.v;
  s.scene.acceleration(s.x, s.v, s.a);
  s.v += h * s.a;
}

void velocity_verlet(Hand& s) {
  s.scene.acceleration(s.x, s.v, s.a);
  s.v += 0.5 * h * s.a;
  s.x += h * s.v;
  s.scene.acceleration(s.x, s.v, s.a);
  s.v += 0.5 * h * s.a;
}

void rk4(Hand& s) {
  s.scene.acceleration(s.x, s.v, s.a);
  s.y = s.x + 0.5 * h * s.v;
  s.w = s.v + 0.5 * h * s.a;
  s.scene.acceleration(s.y, s.w, s.b);
  s.y = s.x + 0.5 * h * s.w;
  s.w = s.v + 0.5 * h * s.b;
  s.scene.acceleration(s.y, s.w, s.c);
  s.y = s.x + h * s.w;
  s.w = s.v + h * s.c;
  s.scene.acceleration(s.y, s.w, s.d);
  s.x += h * s.v + h * h / 6 * (s.a + s.b + s.c);
  s.v += h / 6 * (s.a + 2 * s.b + 2 * s.c + s.d);
}

void implicit_euler(Hand& s) {
  s.scene.acceleration(s.x, s.v, s.a);
  s.scene.linearize(s.x, s.v, s.linear);
  s.linear->stiffness_times(s.v, s.b);
  s.a = h * (s.a - h * s.b);
  solve(s, h, s.a, s.b);
  s.v += s.b;
  s.x += h * s.v;
}

void bdf2(Hand& s) {
  constexpr double g = 2 * h / 3;
  s.w = 2 * s.v - s.v_before;
  s.y = (4 * s.x - s.x_before) / 3 + g * s.w;
  s.scene.acceleration(s.y, s.w, s.a);
  s.scene.linearize(s.y, s.w, s.linear);
  s.a = (4 * s.v - s.v_before) / 3 + g * s.a - s.w;
  solve(s, g, s.a, s.b);
  s.x_before.swap(s.x);
  s.v_before.swap(s.v);
  s.x = s.y + g * s.b;
  s.v = s.w + s.b;
}

void sdirk2(Hand& s) {
  static const double gamma = 1 - std::sqrt(0.5);
  const double g = gamma * h, rest = h - g;
  s.y = s.x + g * s.v;
  s.scene.acceleration(s.y, s.v, s.a);
  s.scene.linearize(s.y, s.v, s.linear);
  s.a *= g;
  solve(s, g, s.a, s.b);
  s.w = s.v + s.b;  // V_1, and f_1 = b / g
  s.y = s.x + rest * s.w + g * s.w;
  s.scene.acceleration(s.y, s.w, s.a);
  s.a = s.v + rest / g * s.b + g * s.a - s.w;
  solve(s, g, s.a, s.c);
  s.x = s.y + g * s.c;
  s.v = s.w + s.c;
}

const std::map<std::string, void (*)(Hand&)> loops{{"symplectic-euler", symplectic_euler},
                                                   {"velocity-verlet", velocity_verlet},
                                                   {"rk4", rk4},
                                                   {"implicit-euler", implicit_euler},
                                                   {"bdf2", bdf2},
                                                   {"sdirk2", sdirk2}};

void step(benchmark::State& state, const std::string& method) {
  const int n = static_cast<int>(state.range(0));
  std::vector<int> first_row(n);
  for (int j = 0; j < n; ++j) first_row[j] = j;
  const SpringNet net = make_net(Grid{n, n, 0.025}, {.particle_mass = 1.25e-4, .stiffness = {200, 100, 20}});
  Scene scene(net, first_row, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{1, 1e-6});
  State<Vector> ours = scene.rest_state();
  const Method described(method);
  const auto stepper = described.stepper();
  Hand hand(scene, ours);
  stepper->start(scene, h, ours);
  if (method == "bdf2") hand.x_before = ours.memory[0], hand.v_before = ours.memory[1];

  const auto loop = loops.at(method);
  std::vector<double> ratios;
  for (auto _ : state) {
    const double start = thread_seconds();
    if (stepper->step(scene, h, ours) != StepStatus::done)
      throw std::runtime_error("the step of a benchmark failed");
    const double between = thread_seconds();
    loop(hand);
    benchmark::ClobberMemory();
    ratios.push_back((between - start) / (thread_seconds() - between));
    if (ratios.size() == 3 && !((ours.x - hand.x).norm() <= 1e-9 * hand.x.norm()))  // before rounding grows
      throw std::runtime_error("'" + method + "' and its loop by hand differ");
  }
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  state.counters["of_hand_loop"] = ratios[ratios.size() / 2];
}

const bool registered = [] {
  for (const auto& [method, loop] : loops)
    for (const int n : {16, 64, 256})
      benchmark::RegisterBenchmark(("step/" + method).c_str(), step, method)
          ->Arg(n)
          ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace springstab::bench::steps
