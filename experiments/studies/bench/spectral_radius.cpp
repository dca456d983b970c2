// The raster of a stability region: ρ(A) on 1000 × 1000 cells, each method. One core; items are cells.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "analysis/method.h"
#include "analysis/regions/amplification.h"

namespace springstab::bench::radii {
namespace {

void spectral_radius(benchmark::State& state, std::string_view method) {
  constexpr int n = 1000;
  std::vector<double> x, y, rho(n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      x.push_back(-1 + 6 * (i + 0.5) / n);
      y.push_back(10 * (j + 0.5) / n);
    }
  for (auto _ : state) {
    springstab::spectral_radius(method, x, y, rho);
    benchmark::DoNotOptimize(rho.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * n * n);
}

const bool registered = [] {
  for (const springstab::Method& method : springstab::all_methods())
    benchmark::RegisterBenchmark(("spectral_radius/" + method.name()).c_str(), spectral_radius, method.name())
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace springstab::bench::radii
