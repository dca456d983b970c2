// StructureLimits, as what the dataclasses of Python are made of: their fields by name.
#include "experiments/limits_words.h"
#include "python/bindings.h"

namespace springstab {
namespace {

py::dict fields(const StiffestMode& k0) {
  py::dict d;
  d["value"] = k0.converged ? std::optional(k0.value) : std::nullopt;
  d["converged"] = k0.converged;
  d["value_kind"] = k0.converged ? std::optional(value_kind(k0)) : std::nullopt;
  d["residual"] = k0.converged ? std::optional(k0.residual) : std::nullopt;
  d["upper_bound"] = k0.upper_bound;
  d["bound"] = name(k0.bound_kind);
  d["smallest"] = k0.smallest;
  d["products"] = k0.products;
  return d;
}

py::dict fields(const DampingModel& damping) {
  py::dict d;
  d["kind"] = name(damping.kind);
  const bool general = damping.kind == DampingModel::Kind::general;
  d["d0"] = general ? std::nullopt : std::optional(damping.d0);
  d["alpha"] =
      general || damping.kind == DampingModel::Kind::designed ? std::nullopt : std::optional(damping.alpha);
  return d;
}

py::dict fields(const Method& method, const MethodLimits& limits, double d0) {
  py::dict d;
  d["name"] = method.name();
  d["status"] = name(limits.status);
  d["h_max"] = limits.h_max;
  d["h_max_source"] = limits.h_max ? std::optional(name(limits.source)) : std::nullopt;
  d["h_certified"] = limits.h_certified;
  d["h_certified_source"] = limits.h_certified ? std::optional(name(limits.proof)) : std::nullopt;
  d["reason"] = limits.h_certified ? std::nullopt : std::optional(std::string(limits.unproved));
  d["recommended_step"] = limits.recommended;
  d["designed"] = py::none();
  if (limits.designed && limits.designed->h_max > 0)
    d["designed"] = py::make_tuple(limits.designed->h_max, limits.designed->alpha, d0);
  d["h_every_pose"] = limits.every_pose;
  d["transient_growth"] = limits.transient_growth;
  return d;
}

struct Answer {
  StructureLimits limits;
  std::vector<std::pair<Method, MethodLimits>> methods;
  std::optional<double> growth;
};

Answer answer(Input& input, std::vector<Method> methods, const StructureLimitsOptions& options) {
  const py::gil_scoped_release others_run;
  if (methods.empty()) methods = all_methods();
  Structure structure = input.model().structure(input.model().initial_state(options.seed));
  if (options.certify && input.scene()) structure.every_pose = input.scene()->every_pose();
  Answer a{StructureLimits(std::move(structure), options), {}, {}};
  for (const Method& method : methods) a.methods.emplace_back(method, a.limits.limits(method));
  if (a.limits.k0().converged) a.growth = a.limits.growth();
  return a;
}

}  // namespace

void bind_limits(py::module_& module) {
  module.def(
      "limits",
      [](Input& input, const std::vector<Method>& methods, double safety, std::optional<double> max_step,
         std::uint64_t seed, bool certify, int digits, double certify_loss) {
        Answer a = answer(input, methods,
                          {.safety = safety,
                           .certify = certify,
                           .seed = seed,
                           .digits = digits,
                           .certify_loss = certify_loss,
                           .max_step = max_step,
                           .before_product = check_for_interrupt});
        const auto& [matrices, damping, every_pose] = a.limits.structure();
        py::dict d, list;
        for (const auto& [method, limits] : a.methods)
          list[py::str(method.name())] = fields(method, limits, damping.d0);
        d["degrees_of_freedom"] = matrices.size();
        d["condensed"] = matrices.condensed;
        d["symmetric"] = matrices.symmetric;
        d["stiffness_indefinite"] = a.limits.k0().indefinite;
        d["growth_rate"] = a.growth;
        d["k0"] = fields(a.limits.k0());
        d["damping"] = fields(damping);
        d["safety"] = safety;
        d["methods"] = list;
        return d;
      },
      py::arg("input"), py::arg("methods"), py::arg("safety"), py::arg("max_step"), py::arg("seed"),
      py::arg("certify"), py::arg("digits"), py::arg("certify_loss"));
}

}  // namespace springstab
