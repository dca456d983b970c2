// Runs, with their frames as arrays.
#include "analysis/constants.h"
#include "analysis/limits/step_policy.h"
#include "experiments/runs/contact_steps.h"
#include "experiments/runs/step_run.h"
#include "experiments/simulate_report.h"
#include "python/bindings.h"
#include "solvers/simulation.h"

namespace springstab {
namespace {

using Callback = std::function<py::object(double, const Vector&, const Vector&)>;

struct Frames {
  double interval = 0;  // [s]; 0 for none
  std::vector<double> times{}, positions{};
  py::ssize_t rows = 0, columns = 0;  // of one frame; columns 0 for a vector

  void record(const Subject& input, double t, const Vector& x) {
    while (!times.empty() && times.back() >= t) {  // a divergence was undone
      times.pop_back();
      positions.resize(times.size() * rows * std::max<py::ssize_t>(columns, 1));
    }
    if (t < next()) return;
    times.push_back(t);
    if (input.scene()) {
      const std::vector<Eigen::Vector3d> vertices = input.vertices(x);
      rows = py::ssize_t(vertices.size()), columns = 3;
      for (const Eigen::Vector3d& p : vertices) positions.insert(positions.end(), p.data(), p.data() + 3);
    } else {
      rows = x.size();
      positions.insert(positions.end(), x.begin(), x.end());
    }
  }

  /// When the next one is due.
  double next() const {
    return interval > 0 ? interval * (1 - 1e-12) * static_cast<double>(times.size()) : infinity;
  }

  py::array_t<double> array() const {
    std::vector<py::ssize_t> shape{py::ssize_t(times.size()), rows};
    if (columns > 0) shape.push_back(columns);
    return py::array_t<double>(shape, positions.data());
  }
};

State<Vector> start_of(Model& model, std::uint64_t seed, const std::optional<Vector>& x,
                       const std::optional<Vector>& v) {
  State<Vector> state = model.initial_state(seed);
  const auto take = [](const std::optional<Vector>& given, const char* what, Vector& into) {
    if (!given) return;
    if (given->size() != into.size() || !given->allFinite())
      throw std::invalid_argument(std::string(what) + " has " + std::to_string(given->size()) +
                                  " values, expected " + std::to_string(into.size()) + " finite ones");
    into = *given;
  };
  if ((x || v) && !model.is_linear())
    throw std::invalid_argument("x and v are for matrices; a scene says how it starts");
  take(x, "x", state.x);
  take(v, "v", state.v);
  return state;
}

py::dict simulate(Subject& model, const StepOptions& options, bool designed, int newton, int frames,
                  const Callback& callback, const std::optional<Vector>& x, const std::optional<Vector>& v) {
  if (designed) {
    expect_designable(model);
    model.design_damping();
  }
  const State<Vector> start = start_of(model, options.seed, x, v);
  StepsInContact in_contact(model, start, options);
  StepChooser chooser(model, in_contact.options());
  State<Vector> state = start;
  Frames kept{.interval = frames > 0 ? options.duration / frames : 0};
  const auto stepper = options.method.stepper();
  if (model.scene()) stepper->set_newton({.steps = newton});
  SimulationResult result;
  StepPlan plan{};
  bool stopped = false;
  {
    const py::gil_scoped_release others_run;
    const std::optional<StepPlan> first = chooser.first_plan();
    if (!first) throw std::invalid_argument(reason_text(chooser));
    plan = *first;
    const auto observe = [&](const RunSoFar& so_far, const State<Vector>& now) {
      check_for_interrupt();
      kept.record(model, so_far.time, now.x);
      if (!callback) return true;
      const py::gil_scoped_acquire lock;
      stopped = callback(so_far.time, now.x, now.v).is(py::bool_(false));
      return !stopped;
    };
    const auto contact = model.contact_filter();
    in_contact.follow(contact.get(), chooser);
    EnergyWatch watch = chooser.watch(start);
    if (contact) watch = with_obstacles(watch, *model.contact());
    const UnseenUntil unseen_until = [&] { return callback ? -infinity : kept.next(); };
    result = springstab::simulate(model.system(), *stepper, plan, watch, state, observe,
                                  in_contact.policy(chooser), contact.get(), unseen_until);
  }
  py::dict d;
  d["method"] = chooser.method().name();
  d["step"] = plan.h;
  d["steps"] = result.steps;
  d["time"] = result.time;
  d["status"] = stopped ? "stopped" : outcome(result.status);
  d["diverged_at"] = result.status == StepStatus::diverged ? std::optional(result.failed_at) : std::nullopt;
  d["energy"] =
      py::make_tuple(model.system().kinetic_energy(start.v) + model.system().potential_energy(start.x),
                     model.system().kinetic_energy(state.v) + model.system().potential_energy(state.x));
  d["times"] = py::array_t<double>(py::ssize_t(kept.times.size()), kept.times.data());
  d["frames"] = kept.array();
  d["x"] = std::move(state.x);
  d["v"] = std::move(state.v);
  return d;
}

}  // namespace

void bind_simulate(py::module_& module) {
  module.def(
      "simulate",
      [](Subject& input, const Method& method, double duration, std::optional<double> step,
         std::optional<double> max_step, double safety, double relinearize, bool designed, int newton,
         std::uint64_t seed, int frames, const Callback& callback, const std::optional<Vector>& x,
         const std::optional<Vector>& v) {
        const StepOptions options{.method = method,
                                  .duration = duration,
                                  .step = step,
                                  .max_step = max_step,
                                  .safety = safety,
                                  .relinearize = relinearize,
                                  .seed = seed};
        return simulate(input, options, designed, newton, frames, callback, x, v);
      },
      py::arg("input"), py::arg("method"), py::arg("duration"), py::arg("step"), py::arg("max_step"),
      py::arg("safety"), py::arg("relinearize"), py::arg("designed"), py::arg("newton"), py::arg("seed"),
      py::arg("frames"), py::arg("callback"), py::arg("x"), py::arg("v"));
}

}  // namespace springstab
