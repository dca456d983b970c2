// The figures of docs/speed.md, each beside what was wanted:
//     ./run bench --benchmark_filter=table --benchmark_counters_tabular=true
// The scenes are experiments/scenes/hanging_net_64.json and hanging_cloth_64.json. One core, CPU time, the
// least of several runs.
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "analysis/method.h"
#include "experiments/runs/measured_run.h"
#include "experiments/runs/step_run.h"
#include "experiments/studies/bench/measure.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab::bench::table {
namespace {

constexpr double h_implicit = 0.01;  // [s]

struct Model {
  const char *name, *scene;
  double implicit_ms, force_ms;  // wanted
};

const Model models[] = {{"springs", "hanging_net_64.json", 15, 0.08},
                        {"baraff-witkin", "hanging_cloth_64.json", 25, 0.5}};

Subject load(const Model& model) {
  InputOptions input;
  input.file = std::string(SPRINGSTAB_SCENES_DIR) + "/" + model.scene;
  return Subject(input);
}

/// 0.2 s into the fall.
State<Vector> falling(Scene& scene) {
  State<Vector> state = scene.rest_state();
  const auto stepper = Method("implicit-euler").stepper();
  for (int k = 0; k < 20; ++k) stepper->step(scene, h_implicit, state);
  return state;
}

void report(benchmark::State& state, double value, double wanted) {
  state.counters["measured"] = value;
  state.counters["wanted"] = wanted;
}

// The mean step of the first half second of the drape, conjugate gradients to 1e-6 [ms].
void implicit_step(benchmark::State& state, const Model& model, SolverKind solver) {
  Subject subject = load(model);
  Scene& scene = *subject.scene();
  scene.solver().kind = solver;
  constexpr int steps = 50;
  double least = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    State<Vector> s = scene.rest_state();
    const auto stepper = Method("implicit-euler").stepper();
    least = std::min(least, least_seconds(1, [&] {
                       for (int k = 0; k < steps; ++k)
                         if (stepper->step(scene, h_implicit, s) != StepStatus::done)
                           throw std::runtime_error("the drape failed");
                     }));
  }
  report(state, 1e3 * least / steps, model.implicit_ms);
}

// A step of symplectic Euler: one force with its damping, and the state advanced [ms].
void force_step(benchmark::State& state, const Model& model) {
  Subject subject = load(model);
  State<Vector> s = falling(*subject.scene());
  const auto stepper = Method("symplectic-euler").stepper();
  double least = std::numeric_limits<double>::infinity();
  for (auto _ : state)
    least = std::min(least, least_seconds(1, [&] { stepper->step(subject.system(), 1e-9, s); }));
  report(state, 1e3 * least, model.force_ms);
}

// Linearized explicit Euler with its damping fitted to the step, linearized every 0.01 s with the projected
// Hessian, over the first 0.2 s of the drape, the choice of the step apart [CPU-seconds per simulated
// second].
void linearized(benchmark::State& state, const Model& model) {
  constexpr double duration = 0.2;  // [s]
  double least = std::numeric_limits<double>::infinity(), h = 0;
  long rollbacks = 0;
  for (auto _ : state) {
    Subject subject = load(model);
    subject.design_damping();
    subject.scene()->set_hessian(Hessian::projected);
    SimulateOptions options;
    options.method = "linearized-explicit-euler";
    options.duration = duration;
    StepChooser chooser(subject, step_options({}, options));
    const StepPlan plan = chooser.first_plan().value();
    const State<Vector> start = subject.initial_state(1);
    const MeasuredRun run = measured_run(subject.system(), options.method, plan, chooser.watch(start), start,
                                         {}, chooser.policy());
    if (run.result.status != StepStatus::done) throw std::runtime_error("the drape failed");
    least = std::min(least, run.cpu_seconds);
    h = plan.h;
    rollbacks = chooser.decisions().rollbacks;
  }
  report(state, least / duration, 0.5);
  state.counters["h_ms"] = 1e3 * h;
  state.counters["rollbacks"] = static_cast<double>(rollbacks);
}

// An assembly of K, in products with it.
void assembly(benchmark::State& state, const Model& model) {
  Subject subject = load(model);
  const State<Vector> s = falling(*subject.scene());
  auto linear = subject.scene()->linearization(s);
  double least = std::numeric_limits<double>::infinity();
  double product = least;
  for (auto _ : state) {
    least = std::min(least, least_seconds(1, [&] { subject.scene()->linearize(s.x, s.v, linear); }));
    product = std::min(product, product_seconds(linear->stiffness(), s.x));
  }
  report(state, least / product, 6);
}

// A product with K of a net of n x n particles, as a fraction of the bandwidth that a plain sum reads at.
void product(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Scene scene(make_net(Grid{n, n, 0.025}, {.particle_mass = 1.25e-4, .stiffness = {200, 100, 20}}), {},
              {0, 0, 0}, {});
  const State<Vector> s = scene.rest_state();
  const auto linear = scene.linearization(s);
  const BlockSparseMatrix& k = linear->stiffness();
  double best = 0;
  for (auto _ : state) {
    const double bandwidth = read_bandwidth();
    best = std::max(best, product_bytes(k) / product_seconds(k, s.x) / bandwidth);
  }
  report(state, best, 0.9);
}

/// What this process occupies [B].
double resident_bytes() {
  long size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// What a scene of 512 x 512 particles with its state occupies after a step [B per particle].
template <class Cloth>
void memory(benchmark::State& state, Cloth (*make)(Grid), const char* method) {
  constexpr int n = 512;
  for (auto _ : state) {
    const Cloth cloth = make(Grid{n, n, 0.025});
    const double before = resident_bytes();
    Scene scene(cloth, {0}, {0, -9.81, 0}, {1, 1e-3});
    State<Vector> s = scene.rest_state();
    const auto stepper = Method(method).stepper();
    stepper->step(scene, 1e-5, s);
    state.counters["bytes/particle"] = (resident_bytes() - before) / n / n;
  }
}

SpringNet net(Grid grid) { return make_net(grid, {.particle_mass = 1.25e-4, .stiffness = {200, 100, 20}}); }

TriangleCloth cloth(Grid grid) {
  grid.diagonals = Diagonals::alternating;
  return make_cloth(grid, {.particle_mass = 1.25e-4, .stiffness = {1000, 1000, 100, 1e-5}});
}

const bool registered = [] {
  using benchmark::kMillisecond;
  const auto line = [](const std::string& name, auto run, auto... arguments) {
    return benchmark::RegisterBenchmark(("table/" + name).c_str(), run, arguments...)->Unit(kMillisecond);
  };
  for (const Model& model : models) {
    const std::string name = model.name;
    line(name + "/implicit_step_ms", implicit_step, model, SolverKind::conjugate_gradients)->Iterations(5);
    line(name + "/implicit_step_direct_ms", implicit_step, model, SolverKind::cholesky)->Iterations(1);
    line(name + "/explicit_force_step_ms", force_step, model)->Iterations(500);
    line(name + "/leu_seconds_per_second", linearized, model)->Iterations(5);
    line(name + "/assembly_in_products", assembly, model)->Iterations(50);
  }
  line("springs/product_of_read_bandwidth", product)->Arg(1000)->Iterations(5);
  for (const char* method : {"symplectic-euler", "linearized-explicit-euler", "implicit-euler"}) {
    line(std::string("springs/memory/") + method, memory<SpringNet>, net, method)->Iterations(1);
    line(std::string("baraff-witkin/memory/") + method, memory<TriangleCloth>, cloth, method)->Iterations(1);
  }
  return true;
}();

}  // namespace
}  // namespace springstab::bench::table
