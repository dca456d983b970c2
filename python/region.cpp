// Methods and their regions.
#include "experiments/region.h"

#include <pybind11/operators.h>

#include "analysis/regions/amplification.h"
#include "analysis/regions/stability_region.h"
#include "experiments/inputs/method_file.h"
#include "python/bindings.h"

namespace springstab {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

Array radii_at(const Method& method, const Array& x, const Array& y) {
  if (x.size() != y.size())
    throw std::invalid_argument("x and y have " + std::to_string(x.size()) + " and " +
                                std::to_string(y.size()) + " values, expected as many of both");
  Array rho(std::vector<py::ssize_t>(x.shape(), x.shape() + x.ndim()));
  const std::span from_x(x.data(), x.size()), from_y(y.data(), y.size());
  const std::span to(rho.mutable_data(), rho.size());
  const py::gil_scoped_release others_run;
  spectral_radius(method, from_x, from_y, to);
  return rho;
}

const StabilityRegion& region_of(const Method& method) {
  const py::gil_scoped_release others_run;
  return stability_region(method);
}

py::dict constants_of(const Method& method) {
  const RegionConstants& c = region_of(method).constants();
  py::dict d;
  d["y_max"] = c.y_max;
  d["x_at_y_max"] = std::isfinite(c.x_at_y_max) ? std::optional(c.x_at_y_max) : std::nullopt;
  d["y_max_attained"] = c.y_max_attained;
  d["real_interval"] = c.real_interval;
  d["imaginary_interval"] = c.imaginary_interval;
  return d;
}

py::list arcs_of(const Method& method, const std::optional<std::array<double, 4>>& wanted) {
  const StabilityRegion& region = region_of(method);
  const Window window =
      wanted ? Window{(*wanted)[0], (*wanted)[1], (*wanted)[2], (*wanted)[3]} : region.natural_window(0.1);
  std::vector<BoundaryArc> arcs;
  {
    const py::gil_scoped_release others_run;
    arcs = region.boundary(window);
  }
  py::list list;
  for (const BoundaryArc& arc : arcs)
    list.append(py::make_tuple(name(arc.bound), py::array_t<double>(py::ssize_t(arc.x.size()), arc.x.data()),
                               py::array_t<double>(py::ssize_t(arc.y.size()), arc.y.data())));
  return list;
}

}  // namespace

void bind_region(py::module_& module) {
  py::class_<Method>(module, "Method")
      .def(py::init<const std::string&>(), py::arg("name"))
      .def_static("of_file", read_method_file, py::arg("path"))
      .def_static("of_text", parse_method, py::arg("source"), py::arg("text"))
      .def(py::self == py::self)
      .def_property_readonly("name", [](const Method& method) { return method.name(); })
      .def_property_readonly("order", [](const Method& method) { return method.info().order; })
      .def_property_readonly("implicit", [](const Method& method) { return method.info().implicit; })
      .def("amplification", &Method::amplification, py::arg("x"), py::arg("y"))
      .def("constants", constants_of)
      .def("boundary", arcs_of, py::arg("window"))
      .def("spectral_radius", radii_at, py::arg("x"), py::arg("y"))
      .def(
          "critical_step",
          [](const Method& method, double k, double d) { return region_of(method).critical_step(k, d); },
          py::arg("k"), py::arg("d"));
  module.def("methods", [] { return std::pair(all_methods(), more_methods()); });
}

}  // namespace springstab
