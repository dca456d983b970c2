// A run that blew up, from its frames as an array.
#include "experiments/diagnosis.h"
#include "python/bindings.h"

namespace springstab {
namespace {

using FrameArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::dict fields(const diagnosis::MethodOfGrowth& one) {
  py::dict d;
  d["method"] = one.method.name();
  d["step_over_limit"] = one.step_over_limit;
  d["factor"] = one.factor;
  d["distance"] = one.distance;
  d["stiffness"] = one.stiffness;
  d["fits"] = one.fits;
  return d;
}

py::dict fields(const diagnosis::PatternInStructure& seen) {
  py::dict d;
  d["stiffness"] = seen.stiffness;
  d["damping"] = seen.damping;
  d["of_stiffest"] = seen.of_stiffest;
  d["overlap_with_stiffest_mode"] = seen.overlap;
  return d;
}

RunFrames frames_of(const FrameArray& array) {
  const py::ssize_t frames = array.ndim() > 0 ? array.shape(0) : 0;
  if (array.ndim() < 2 || array.ndim() > 3 || frames < 2 || array.size() == 0 ||
      (array.ndim() == 3 && array.shape(2) > 3))
    throw std::invalid_argument(
        "frames: " + std::to_string(array.ndim()) + " dimensions and " + std::to_string(frames) +
        " frames, expected (frames, vertices, 3) or (frames, numbers) of at least two");
  return {Eigen::MatrixXd::Map(array.data(), array.size() / frames, frames),
          array.ndim() == 3 ? static_cast<int>(array.shape(2)) : 1};
}

}  // namespace

void bind_diagnose(py::module_& module) {
  module.def(
      "diagnose",
      [](const FrameArray& array, double h, int every, Subject* input, const std::vector<Method>& methods) {
        const RunFrames frames = frames_of(array);
        Diagnosis found;
        {
          const py::gil_scoped_release others_run;
          found = diagnose(frames, {.h = h, .every = every}, input, input && input->scene() ? input : nullptr,
                           "frames", methods);
        }
        py::dict d;
        d["status"] = name(found.status);
        d["frames"] = found.frames;
        d["used"] = found.used;
        d["step"] = h;
        d["every"] = every;
        d["grows_from"] = found.growth ? std::optional(found.growth->from) : std::nullopt;
        d["grows_to"] = found.growth ? std::optional(found.growth->to) : std::nullopt;
        d["factor"] = found.factor();
        d["frame_factor"] = found.growth ? std::optional(found.growth->factor) : std::nullopt;
        d["e_foldings"] = found.growth ? std::optional(found.growth->e_foldings) : std::nullopt;
        d["residual"] = found.growth ? std::optional(found.growth->residual) : std::nullopt;
        d["vertices"] = found.vertices;
        d["shares"] = found.shares;
        d["shape"] = found.growth ? std::optional(found.growth->pattern) : std::nullopt;
        d["pattern"] = found.seen ? py::object(fields(*found.seen)) : py::none();
        py::list list;
        if (found.seen)
          for (const auto& one : found.seen->methods) list.append(fields(one));
        d["methods"] = list;
        return d;
      },
      py::arg("frames"), py::arg("h"), py::arg("every"), py::arg("input").none(true), py::arg("methods"));
}

}  // namespace springstab
