// What detection costs a step: sheets of n × n particles, 25 mm apart, that ripple at 1 m/s, in steps of
// 0.267 ms; flat ones, and ones folded to four layers 4 mm apart. Each step asks for the proximities at 3 mm
// and for the collisions on the way, so that what finds pairs anew now and then is in the average. One core.
#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>

#include "experiments/studies/bench/measure.h"
#include "solvers/contact/surface_pairs.h"

namespace springstab::bench::surfaces {
namespace {

constexpr double spacing = 0.025, apart = 0.004, reach = 0.003, skin = 0.004;  // [m]
constexpr double speed = 1, step = 2.67e-4;                                    // [m/s], [s]

Surface sheet(int n) {
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      const int a = i * n + j, b = a + 1, c = a + n, d = c + 1;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  return make_surface(std::move(triangles));
}

/// Where it is at t: waves of 0.1 m run through all layers alike, and through each one by itself at a tenth.
void place(std::vector<Eigen::Vector3d>& x, int n, bool folded, double t) {
  constexpr double wave = 5, high = 0.1;  // [1/m], [m]
  const int width = folded ? (n + 3) / 4 : n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int layer = i / width, along = layer % 2 == 0 ? i % width : width - 1 - i % width;
      const double u = spacing * along, v = spacing * j, phase = speed / high * t + wave * (u + v / 2);
      x[i * n + j] = {u, apart * layer + high * std::sin(phase) + 0.001 * std::sin(3 * phase + layer), v};
    }
}

void detect(benchmark::State& state, bool folded) {
  const int n = static_cast<int>(state.range(0)), particles = n * n;
  SurfacePairs pairs(sheet(n), particles, {reach, skin});
  std::vector<Eigen::Vector3d> now(particles), next(particles);
  place(now, n, folded, 0);
  double seconds = 0;
  long steps = 0, near = 0;
  for (auto _ : state) {
    place(next, n, folded, static_cast<double>(++steps) * step);
    const double start = thread_seconds();
    near += static_cast<long>(pairs.proximities(now, reach).size());
    benchmark::DoNotOptimize(pairs.collisions(now, next).data());
    seconds += thread_seconds() - start;
    now.swap(next);
  }
  const auto each = static_cast<double>(steps);
  state.counters["ms/step"] = 1e3 * seconds / each;
  state.counters["triangles"] = 2. * (n - 1) * (n - 1);
  state.counters["kept"] = static_cast<double>(pairs.counts().kept) / 2 / each;
  state.counters["tested"] = static_cast<double>(pairs.counts().tested) / 2 / each;
  state.counters["near"] = static_cast<double>(near) / each;
  state.counters["steps/rebuild"] = each / static_cast<double>(pairs.counts().rebuilds);
}

void flat(benchmark::State& state) { detect(state, false); }
void folded(benchmark::State& state) { detect(state, true); }

BENCHMARK(flat)->Name("surfaces/flat")->Arg(32)->Arg(64)->Arg(128)->Arg(224)->Iterations(100);
BENCHMARK(folded)->Name("surfaces/four_layers")->Arg(32)->Arg(64)->Arg(128)->Arg(224)->Iterations(100);

}  // namespace
}  // namespace springstab::bench::surfaces
