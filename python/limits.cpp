// StructureLimits, as what the dataclasses of Python are made of: their fields by name.
#include "analysis/limits/cheapest_method.h"
#include "analysis/limits/for_step.h"
#include "analysis/limits/stiffest_motion.h"
#include "experiments/cheapest_report.h"
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

/// What is asked beyond the limits themselves.
struct Questions {
  std::optional<double> for_step;  // [s]
  std::optional<double> error;
  bool stiffest;
};

struct Answer {
  StructureLimits limits;
  std::vector<std::pair<Method, MethodLimits>> methods{};
  std::optional<double> growth{};
  std::vector<StepAnswer> at_step{};  // one a method, or none
  std::optional<StiffestMotion> motion{};
  CheapestOptions wanted{};
  std::unique_ptr<CheapestMethod> cheapest{};
};

Answer answer(Subject& input, std::vector<Method> methods, const StructureLimitsOptions& options,
              const Questions& asked) {
  const py::gil_scoped_release others_run;
  if (methods.empty()) methods = all_methods();
  const State<Vector> start = input.initial_state(options.seed);
  Structure structure = input.structure(start);
  if (options.certify) structure.every_pose = input.every_pose();
  Answer a{.limits = StructureLimits(std::move(structure), options)};
  a.limits.expect(methods);
  for (const Method& method : methods) a.methods.emplace_back(method, a.limits.limits(method));
  if (!a.limits.k0().converged) return a;
  a.growth = a.limits.growth();
  if (asked.for_step) {
    ForStep question(a.limits, *asked.for_step, input.unknowns_a_particle());
    for (const Method& method : methods) a.at_step.push_back(question.of(method));
  }
  if (asked.stiffest)
    a.motion =
        stiffest_motion(a.limits.structure().matrices, input.elements(start.x), {.seed = options.seed});
  if (asked.error) {
    a.wanted.error = asked.error;
    a.cheapest = std::make_unique<CheapestMethod>(a.limits, input, start, methods, a.wanted);
  }
  return a;
}

py::dict fields(const MassScaling& scaling, const std::vector<long>& numbers) {
  py::dict d, particles;
  for (const auto& [particle, mass] : scaling.particles)
    particles[py::int_(numbers[static_cast<std::size_t>(particle)])] = mass;
  d["particles"] = particles;
  d["added_mass"] = scaling.added_mass;
  d["least_added_mass"] = scaling.least;
  d["proved"] = scaling.proved;
  return d;
}

// With the reasons of what is not there.
template <class Value, class Shown>
void add(py::dict& d, const char* key, const Found<Value>& found, const Shown& shown) {
  d[key] = py::none();
  if (found.value)
    d[key] = shown(*found.value);
  else if (!found.reason.empty())
    d["reasons"][key] = std::string(found.reason);
}

py::dict fields(const StepAnswer& answer, double step, const std::vector<long>& numbers) {
  py::dict d;
  d["step"] = step;
  d["holds"] = answer.holds;
  d["margin"] = answer.margin;
  d["proved"] = answer.proved;
  d["reasons"] = py::dict();
  if (!answer.holds) d["reasons"]["holds"] = std::string(answer.unknown);
  const auto plain = [](auto value) { return value; };
  add(d, "stiffness_factor", answer.stiffness_factor, plain);
  add(d, "alpha", answer.alpha, [](const AlphaRange& range) { return std::pair(range.low, range.high); });
  add(d, "uniform_mass_factor", answer.mass_factor, plain);
  add(d, "mass_scaling", answer.mass_scaling,
      [&](const MassScaling& scaling) { return fields(scaling, numbers); });
  add(d, "substeps", answer.substeps, plain);
  return d;
}

py::dict fields(const StiffestMotion& motion, const Subject& input) {
  const std::vector<long> numbers = input.scene() ? input.vertex_numbers() : input.particle_numbers();
  py::list carriers;
  for (const Carrier& each : motion.carriers) {
    std::vector<long> particles;
    for (const int p : each.particles) particles.push_back(numbers[static_cast<std::size_t>(p)]);
    py::dict one;
    one["kind"] = std::string(each.kind);
    one["index"] = each.kind == "unknown" ? particles.front() : each.index;
    one["share"] = each.share;
    one["vertices"] = particles;
    one["stiffness"] = each.stiffness;
    one["mass"] = each.mass;
    carriers.append(one);
  }
  py::dict d;
  d["carriers"] = carriers;
  d["mode"] = motion.mode;
  d["nodal_bound"] = motion.nodal;
  d["element_bound"] = motion.element;
  return d;
}

py::dict fields(const CheapestMethod& cheapest, const CheapestOptions& wanted) {
  const MethodCost* const best = cheapest.best();
  py::dict d;
  d["method"] = best ? std::optional(best->method.name()) : std::nullopt;
  d["step"] = best ? std::optional(best->step) : std::nullopt;
  d["cpu_seconds_per_second"] = best ? best->cost() : std::nullopt;
  d["error"] = best ? best->error : std::nullopt;
  d["error_over"] = cheapest.motion() ? std::optional(cheapest.duration()) : std::nullopt;
  d["reason"] = reason(cheapest, wanted);
  return d;
}

py::dict fields(Answer& a, const Questions& asked, const Subject& input) {
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
  d["methods"] = list;
  for (const char* key : {"for_step", "stiffest", "cheapest"}) d[key] = py::none();
  if (!a.at_step.empty()) {
    const std::vector<long> numbers = input.particle_numbers();
    py::dict answers;
    for (std::size_t i = 0; i < a.at_step.size(); ++i)
      answers[py::str(a.methods[i].first.name())] = fields(a.at_step[i], *asked.for_step, numbers);
    d["for_step"] = answers;
  }
  if (a.motion) d["stiffest"] = fields(*a.motion, input);
  if (a.cheapest) d["cheapest"] = fields(*a.cheapest, a.wanted);
  return d;
}

}  // namespace

void bind_limits(py::module_& module) {
  module.def(
      "limits",
      [](Subject& input, const std::vector<Method>& methods, double safety, std::optional<double> max_step,
         std::uint64_t seed, bool certify, int digits, double certify_loss, std::optional<double> for_step,
         std::optional<double> error, bool stiffest) {
        const Questions asked{for_step, error, stiffest};
        Answer a = answer(input, methods,
                          {.safety = safety,
                           .certify = certify,
                           .seed = seed,
                           .digits = digits,
                           .certify_loss = certify_loss,
                           .max_step = max_step,
                           .before_product = check_for_interrupt},
                          asked);
        py::dict d = fields(a, asked, input);
        d["safety"] = safety;
        return d;
      },
      py::arg("input"), py::arg("methods"), py::arg("safety"), py::arg("max_step"), py::arg("seed"),
      py::arg("certify"), py::arg("digits"), py::arg("certify_loss"), py::arg("for_step"), py::arg("error"),
      py::arg("stiffest"));
}

}  // namespace springstab
