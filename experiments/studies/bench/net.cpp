// The speed table for nets of springs: square ones like experiments/scenes/hanging_net_64.json, 10² to 10⁶
// particles, the first row pinned, 0.2 s into their fall (larger nets: waved). One core. Every line has its
// time per particle; what is bound by memory also GB/s and the fraction of the bandwidth that a plain sum
// over a large array reads at, measured just before; the others their time in block products, measured just
// before as well.
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "analysis/method.h"
#include "experiments/studies/bench/measure.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab::bench::nets {
namespace {

constexpr double h_implicit = 0.01;  // [s]

struct Net {
  std::unique_ptr<Scene> scene;
  State<Vector> state;
  double particles;
};

Net make(int n) {
  const SpringNet net = make_net(Grid{n, n, 0.025}, {.particle_mass = 1.25e-4, .stiffness = {200, 100, 20}});
  std::vector<int> first_row(n);
  for (int j = 0; j < n; ++j) first_row[j] = j;
  Net made{std::make_unique<Scene>(net, first_row, Eigen::Vector3d(0, -9.81, 0), RayleighDamping{1, 1e-3}),
           {},
           static_cast<double>(n) * n};
  made.state = made.scene->rest_state();
  if (n <= 128) {
    const auto stepper = Method("implicit-euler").stepper();
    for (int k = 0; k < 20; ++k) stepper->step(*made.scene, h_implicit, made.state);
  } else {
    for (Eigen::Index i = 0; i < made.state.x.size(); i += 3) {
      made.state.x[i + 1] = 0.01 * std::sin(9 * made.state.x[i] + 5 * made.state.x[i + 2]);
      made.state.x[i + 2] *= 1.02;
      made.state.v[i + 1] = 0.1;
    }
  }
  return made;
}

Net& net(int n) {
  static std::map<int, Net> kept;
  if (!kept.contains(n)) {
    kept.clear();  // the large ones take a gigabyte
    kept.emplace(n, make(n));
  }
  return kept.at(n);
}

/// Runs work, of which `bytes` are the memory moved or, if 0, `unit` the seconds of a block product.
template <class Work>
void run(benchmark::State& state, const Net& subject, double bytes, double unit, const Work& work) {
  const double bandwidth = bytes > 0 ? read_bandwidth() : 0;
  double least = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const double start = thread_seconds();
    work();
    benchmark::ClobberMemory();
    least = std::min(least, thread_seconds() - start);
  }
  state.counters["best_us"] = 1e6 * least;
  state.counters["ns/particle"] = 1e9 * least / subject.particles;
  if (bytes > 0) {
    state.counters["GB/s"] = 1e-9 * bytes / least;
    state.counters["of_bandwidth"] = bytes / least / bandwidth;
  } else {
    state.counters["products"] = least / unit;
  }
}

void read(benchmark::State& state) {
  double best = 0;
  for (auto _ : state) best = std::max(best, read_bandwidth());
  state.counters["GB/s"] = 1e-9 * best;
}
BENCHMARK(read)->Unit(benchmark::kMillisecond);

void product(benchmark::State& state) {
  Net& n = net(static_cast<int>(state.range(0)));
  const auto linear = n.scene->linearization(n.state);
  const BlockSparseMatrix& k = linear->stiffness();
  Vector out(n.state.x.size());
  run(state, n, product_bytes(k), 0, [&] { k.multiply(n.state.x.data(), out.data()); });
}

// The loop that anyone would write.
void plain_product(benchmark::State& state) {
  Net& n = net(static_cast<int>(state.range(0)));
  const auto linear = n.scene->linearization(n.state);
  const BlockSparseMatrix& k = linear->stiffness();
  Vector out(n.state.x.size());
  run(state, n, product_bytes(k), 0, [&] {
    out.setZero();
    for (int i = 0; i < k.rows(); ++i)
      for (long place = k.row_begin(i); place <= k.diagonal(i); ++place) {
        const int j = k.column(place);
        const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(k.block(place));
        out.segment<3>(3 * i) += block * n.state.x.segment<3>(3 * j);
        if (i != j) out.segment<3>(3 * j) += block.transpose() * n.state.x.segment<3>(3 * i);
      }
  });
}

template <class Work>
void run_in_products(benchmark::State& state, const Work& work) {
  Net& n = net(static_cast<int>(state.range(0)));
  auto linear = n.scene->linearization(n.state);
  run(state, n, 0, product_seconds(linear->stiffness(), n.state.x), [&] { work(n, linear); });
}

void force(benchmark::State& state) {
  Vector a;
  net(static_cast<int>(state.range(0))).scene->set_damping({1, 0});
  run_in_products(state, [&](Net& n, const auto&) { n.scene->acceleration(n.state.x, n.state.v, a); });
  net(static_cast<int>(state.range(0))).scene->set_damping({1, 1e-3});
}

void damped_force(benchmark::State& state) {
  Vector a;
  run_in_products(state, [&](Net& n, const auto&) { n.scene->acceleration(n.state.x, n.state.v, a); });
}

void assembly(benchmark::State& state) {
  run_in_products(state, [](Net& n, auto& linear) { n.scene->linearize(n.state.x, n.state.v, linear); });
}

// A step of linearized explicit Euler: one product with K of x + alpha v, and two vectors advanced.
void linear_substep(benchmark::State& state) {
  const auto stepper = Method("explicit-euler").stepper();
  State<Vector> s = net(static_cast<int>(state.range(0))).state;
  s.x *= 1e-6;  // a small displacement
  run_in_products(state, [&](Net&, const auto& linear) {
    stepper->step(*linear, 1e-9, s);  // too short to move far
  });
}

void implicit_step(benchmark::State& state, Preconditioner preconditioner, double tolerance) {
  const auto stepper = Method("implicit-euler").stepper();
  State<Vector> s;
  Net& n = net(static_cast<int>(state.range(0)));
  n.scene->solver() = {.tolerance = tolerance, .preconditioner = preconditioner};
  run_in_products(state, [&](Net&, const auto&) {
    s = n.state;
    stepper->step(*n.scene, h_implicit, s);
  });
  const auto linear = n.scene->linearization(n.state);
  Vector a, y;
  n.scene->acceleration(n.state.x, n.state.v, a);
  linear->stiffness_times(n.state.v, y);
  a = h_implicit * (a - h_implicit * y);
  state.counters["iterations"] =
      static_cast<double>(linear->solve_shifted({1, h_implicit, h_implicit * h_implicit}, a, y).iterations);
  n.scene->solver() = {};
}

const bool registered = [] {
  using benchmark::kMillisecond;
  using benchmark::RegisterBenchmark;
  for (const int n : {16, 32, 64, 128, 256, 512, 1024}) {
    RegisterBenchmark("product", product)->Arg(n)->Unit(kMillisecond);
    RegisterBenchmark("plain_product", plain_product)->Arg(n)->Unit(kMillisecond);
    RegisterBenchmark("force", force)->Arg(n)->Unit(kMillisecond);
    RegisterBenchmark("damped_force", damped_force)->Arg(n)->Unit(kMillisecond);
    RegisterBenchmark("assembly", assembly)->Arg(n)->Unit(kMillisecond);
    RegisterBenchmark("linear_substep", linear_substep)->Arg(n)->Unit(kMillisecond);
    if (n > 128) continue;
    RegisterBenchmark("implicit_step/ssor/1e-6", implicit_step, Preconditioner::block_ssor, 1e-6)
        ->Arg(n)
        ->Unit(kMillisecond);
    RegisterBenchmark("implicit_step/jacobi/1e-6", implicit_step, Preconditioner::block_jacobi, 1e-6)
        ->Arg(n)
        ->Unit(kMillisecond);
    RegisterBenchmark("implicit_step/jacobi/1e-3", implicit_step, Preconditioner::block_jacobi, 1e-3)
        ->Arg(n)
        ->Unit(kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace springstab::bench::nets
