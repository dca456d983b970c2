// Steps of somebody else, in Python.
#include "analysis/spectra/step_map.h"
#include "python/bindings.h"

namespace springstab {
namespace {

using Step = std::function<std::pair<Vector, Vector>(const Vector& x, const Vector& v, double h)>;

py::dict fields(const MethodFit& fit) {
  py::dict d;
  d["method"] = fit.method.name();
  d["distance"] = fit.distance;
  d["h_max"] = fit.h_max;
  return d;
}

}  // namespace

void bind_own_step(py::module_& module) {
  module.attr("same_eigenvalues") = same_eigenvalues;
  module.def(
      "largest_stable_step",
      [](const Step& step, const Vector& x, const Vector& v, const std::vector<Method>& methods,
         double difference, double first_step) {
        const StepMap map{x.size(), [&](double h, Vector& x_now, Vector& v_now) {
                            std::tie(x_now, v_now) = step(x_now, v_now, h);
                          }};
        const StepMapOptions options{.difference = difference, .first_step = first_step};
        const LargestStep largest = largest_stable_step(map, x, v, options);
        py::dict d;
        d["h_max"] = largest.h_max;
        d["leaves_at"] = largest.leaves_at;
        d["steps_tried"] = largest.steps_tried;
        py::list fits;
        for (const MethodFit& fit : methods_that_fit(map, x, v, methods, options)) fits.append(fields(fit));
        d["fits"] = fits;
        return d;
      },
      py::arg("step"), py::arg("x"), py::arg("v"), py::arg("methods"), py::arg("difference"),
      py::arg("first_step"));
}

}  // namespace springstab
