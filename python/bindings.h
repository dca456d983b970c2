// What the parts of the Python extension share. They bind: the numbers are the library's, the words the
// command's. A part that computes lets other threads of the interpreter run meanwhile.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>

#include "experiments/inputs/subject.h"

namespace springstab {

namespace py = pybind11;

/// Raises KeyboardInterrupt where Ctrl-C was typed. To be called without the interpreter's lock.
void check_for_interrupt();

void bind_diagnose(py::module_& module);
void bind_limits(py::module_& module);
void bind_own_step(py::module_& module);
void bind_region(py::module_& module);
void bind_simulate(py::module_& module);

}  // namespace springstab
