// Baraff's and Witkin's cloth on a square net, its first row pinned, gently waved: one evaluation of the
// force, one product with the Hessian without assembling it, one assembly, and one product of the assembled
// matrix, which the assembly is measured against. One core; items are particles.
#include <benchmark/benchmark.h>

#include <cmath>

#include "solvers/scene/bending.h"
#include "solvers/scene/condition_damping.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab::bench::energies {
namespace {

/// The cloth of the speed table (docs/speed.md), and its terms bound to their matrix.
struct Cloth {
  explicit Cloth(int n)
      : free_count(n * (n - 1)),
        cloth(
            make_cloth(Grid{n, n, 0.025}, {.particle_mass = 1.25e-4, .stiffness = {1000, 1000, 100, 1e-5}})) {
    std::vector<int> number;
    for (int i = 0; i < n * n; ++i) number.push_back(i < n ? free_count + i : i - n);
    for (const Eigen::Vector3d& rest : cloth.rest) {
      const double wave = 0.01 * std::sin(9 * rest.x() + 5 * rest.z());
      (rest.z() == 0 ? pinned : x)
          .insert((rest.z() == 0 ? pinned : x).end(), {rest.x(), wave, 1.02 * rest.z()});
    }
    for (RestTriangle& t : cloth.triangles)
      for (int& p : t.particles) p = number[p];
    for (Hinge& h : cloth.hinges)
      for (int& p : h.particles) p = number[p];
    out.resize(x.size());
  }

  int free_count;
  TriangleCloth cloth;
  std::vector<double> x, pinned, out;
};

enum class Part { stretch_shear, bending, both };

template <class Work>
void run(benchmark::State& state, Part part, const Work& work) {
  Cloth c(static_cast<int>(state.range(0)));
  StretchShear membrane(
      std::make_shared<TriangleConditions>(c.cloth.triangles, AreaScaling::continuum, c.free_count),
      c.cloth.material.stiffness.in_plane());
  Bending bending(std::make_shared<HingeAngles>(c.cloth.hinges, c.free_count),
                  c.cloth.material.stiffness.bending);
  Couplings couplings = membrane.couplings();
  const Couplings more = bending.couplings();
  couplings.insert(couplings.end(), more.begin(), more.end());
  BlockSparseMatrix matrix(c.free_count, couplings);
  membrane.bind(matrix.pattern());
  bending.bind(matrix.pattern());
  const ParticleField x{c.x.data(), c.pinned.data(), c.free_count};
  for (auto _ : state) {
    if (part != Part::bending) work(membrane, x, c, matrix);
    if (part != Part::stretch_shear) work(bending, x, c, matrix);
    benchmark::DoNotOptimize(c.out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * c.free_count);
}

void force(benchmark::State& state, Part part) {
  run(state, part, [](const auto& term, const ParticleField& x, Cloth& c, BlockSparseMatrix&) {
    term.add_force(x, c.out.data());
  });
}

void hessian_product(benchmark::State& state, Part part) {
  run(state, part, [](const auto& term, const ParticleField& x, Cloth& c, BlockSparseMatrix&) {
    term.add_stiffness_times(x, c.x.data(), 1e-9, c.out.data());
  });
}

void damped_force(benchmark::State& state, Part part) {
  run(state, part, [](const auto& term, const ParticleField& x, Cloth& c, BlockSparseMatrix&) {
    term.add_damped_force(x, c.x.data(), 1e-9, c.out.data());
  });
}

void assembly(benchmark::State& state, Part part) {
  run(state, part, [](const auto& term, const ParticleField& x, Cloth&, BlockSparseMatrix& matrix) {
    term.add_stiffness(x, matrix);
  });
}

void projected_assembly(benchmark::State& state, Part part) {
  run(state, part, [](const auto& term, const ParticleField& x, Cloth&, BlockSparseMatrix& matrix) {
    term.add_projected_stiffness(x, matrix);
  });
}

void block_product(benchmark::State& state) {
  run(state, Part::stretch_shear,  // once
      [](const auto&, const ParticleField&, Cloth& c, BlockSparseMatrix& matrix) {
        matrix.multiply(c.x.data(), c.out.data());
      });
}

const bool registered = [] {
  const struct {
    std::string name;
    Part part;
  } parts[] = {{"stretch_shear", Part::stretch_shear}, {"bending", Part::bending}, {"both", Part::both}};
  const struct {
    std::string name;
    void (*run)(benchmark::State&, Part);
  } works[] = {{"force", force},
               {"hessian_product", hessian_product},
               {"damped_force", damped_force},
               {"assembly", assembly},
               {"projected_assembly", projected_assembly}};
  const auto sizes = [](benchmark::internal::Benchmark* b) {
    b->Arg(64)->Arg(256)->Unit(benchmark::kMicrosecond);
  };
  for (const auto& work : works)
    for (const auto& part : parts)
      sizes(benchmark::RegisterBenchmark(("cloth/" + work.name + "/" + part.name).c_str(), work.run,
                                         part.part));
  sizes(benchmark::RegisterBenchmark("cloth/block_product", block_product));
  return true;
}();

}  // namespace
}  // namespace springstab::bench::energies
