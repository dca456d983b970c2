// Steps of a linearized method one by one, and together in passes over K (solvers/linear/wavefront.h): on the
// nets of the speed table, waved, sixteen steps of either in turn. Both counters are medians; what a step is
// watched by, its kinetic energy, is within the passes and beside the steps. Arguments: particles a side, and
// threads.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "experiments/studies/bench/measure.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/team.h"

namespace springstab::bench::together {
namespace {

constexpr double h = 1e-9;  // [s], too short to move far
constexpr long steps = 16;

double median(std::vector<double>& times) {
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size()) / 2, times.end());
  return times[times.size() / 2];
}

// Of several threads what the clock says.
double now() {
  if (loop_threads() == 1) return thread_seconds();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Work>
double seconds(const Work& work) {
  const double start = now();
  work();
  benchmark::ClobberMemory();
  return now() - start;
}

void measure(benchmark::State& state, const std::string& method) {
  const int n = static_cast<int>(state.range(0));
  const SpringNet net = make_net(Grid{n, n, 0.025}, {.particle_mass = 1.25e-4, .stiffness = {200, 100, 20}});
  std::vector<int> first_row(n);
  for (int j = 0; j < n; ++j) first_row[j] = j;
  Scene scene(net, first_row, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{1, 1e-3});
  State<Vector> s = scene.rest_state();
  for (Eigen::Index i = 0; i < s.x.size(); i += 3) {
    s.x[i + 1] = 0.01 * std::sin(9 * s.x[i] + 5 * s.x[i + 2]);
    s.v[i + 1] = 0.1;
  }
  const auto stepper = Method(method).stepper();
  stepper->restart(1'000'000'000);
  stepper->step(scene, h, s);
  set_loop_threads(static_cast<int>(state.range(1)));
  std::vector<double> alone, watch, together;
  long at_once = 0;
  double kinetic = 0;
  for (auto _ : state) {
    alone.push_back(seconds([&] {
      for (long k = 0; k < steps; ++k) stepper->step(scene, h, s);
    }));
    watch.push_back(seconds([&] { kinetic = scene.kinetic_energy(s.v); }));
    together.push_back(seconds([&] {
      for (long k = 0; k < steps; k += at_once) {
        at_once = stepper->take_steps(scene, h, steps - k, s, [](long, double) { return true; });
        if (at_once == 0) throw std::runtime_error("the steps of a benchmark were not taken together");
      }
    }));
  }
  set_loop_threads(1);
  benchmark::DoNotOptimize(kinetic);
  const double particles = static_cast<double>(scene.free_particles()), each = 1e9 / particles / steps;
  state.counters["ns/alone"] = each * median(alone);
  state.counters["ns/watch"] = 1e9 / particles * median(watch);
  state.counters["ns/together"] = each * median(together);
  state.counters["at_once"] = static_cast<double>(at_once);
}

const bool registered = [] {
  for (const char* method : {"linearized-explicit-euler", "linearized-rk4"})
    for (const int n : {64, 128, 256, 512, 1024})
      for (const int threads : {1, 2})
        benchmark::RegisterBenchmark(("together/" + std::string(method)).c_str(), measure, method)
            ->Args({n, threads})
            ->Iterations(std::max(3, 512 * 512 * 7 / n / n))
            ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace springstab::bench::together
