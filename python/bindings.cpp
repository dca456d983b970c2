#include "python/bindings.h"

#include <chrono>

#include "experiments/command/output.h"
#include "solvers/io/input_error.h"

namespace springstab {

void check_for_interrupt() {
  using Clock = std::chrono::steady_clock;
  thread_local Clock::time_point next{};
  const Clock::time_point now = Clock::now();
  if (now < next) return;
  next = now + std::chrono::milliseconds(50);
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace springstab

PYBIND11_MODULE(_core, module) {
  using namespace springstab;
  module.doc() = "The library, bound. What is to be used is in the package above.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
  });

  py::class_<Subject>(module, "Input")
      .def(py::init([](const SparseMatrix& k, const std::optional<SparseMatrix>& m,
                       const std::optional<SparseMatrix>& d, const std::optional<SparseMatrix>& implicit) {
             const auto or_none = [](const auto& given) { return given.value_or(SparseMatrix()); };
             return std::make_unique<Subject>(k, or_none(m), or_none(d), or_none(implicit), RayleighDamping(),
                                              true);
           }),
           py::arg("stiffness"), py::arg("mass") = py::none(), py::arg("damping") = py::none(),
           py::arg("implicit_damping") = py::none())
      .def(py::init([](const std::string& file, const std::string& grid, std::optional<double> spacing,
                       const std::string& material, const std::string& pin, std::optional<double> scale,
                       const std::string& diagonals) {
             InputOptions options;
             options.file = file;
             options.grid = grid;
             options.spacing = spacing;
             options.material = material;
             options.pin = pin;
             options.scale = scale;
             options.diagonals = diagonals;
             return std::make_unique<Subject>(options, true);
           }),
           py::kw_only(), py::arg("file"), py::arg("grid"), py::arg("spacing"), py::arg("material"),
           py::arg("pin"), py::arg("scale"), py::arg("diagonals"))
      .def_property_readonly("size", [](Subject& input) { return input.system().size(); })
      .def_property_readonly("is_scene", [](const Subject& input) { return input.scene() != nullptr; })
      .def_property_readonly("faces", &Subject::faces);
  bind_region(module);  // first: the others name its Method
  bind_diagnose(module);
  bind_limits(module);
  bind_own_step(module);
  bind_simulate(module);
}
