#include "experiments/studies/divergence/cloth.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/limits/step_limits.h"
#include "analysis/limits/step_policy.h"
#include "analysis/regions/amplification.h"
#include "experiments/runs/measured_run.h"

namespace springstab {
namespace {

constexpr double air_drag = 1;            // d0 [1/s]
constexpr double linearize_every = 0.01;  // h_m of linearized methods [s]
constexpr double shortest_limit = 0.1;    // of 2/√k0
constexpr double most_safety = 1e4;
constexpr double k0_tolerance = 1e-4;

/// One damping of one method on the scene.
struct Case {
  Method method;
  std::string damping;
  RayleighModes modes;
  double h_limit;
};

std::vector<Case> cases(double k0, const std::vector<Method>& methods) {
  std::vector<Case> all;
  for (const Method& method : methods) {
    if (method.info().implicit) continue;
    const StabilityRegion& region = stability_region(method);
    const double designed = design_damping(region, k0, air_drag).alpha;
    const std::pair<const char*, double> alphas[] = {
        {"air drag", 0}, {"alpha = 1e-4 s", 1e-4}, {"fitted", designed}};
    for (const auto& [name, alpha] : alphas) {
      if (alpha == 0 && name != alphas[0].first) continue;  // the first one again
      const RayleighModes modes{0, k0, air_drag, alpha};
      const double h = critical_step(region, modes);
      if (h >= shortest_limit * 2 / std::sqrt(k0)) all.push_back({method, name, modes, h});
    }
  }
  return all;
}

StepPlan plan(const Method& method, double h, double duration) {
  StepPlan result{h, std::max(1L, std::lround(duration / h))};
  if (method.info().linearized) {
    result.steps_per_linearization = std::max(1L, std::lround(linearize_every / h));
    result.steps = std::max(result.steps, result.steps_per_linearization);
  }
  return result;
}

// The largest |λ| of the modes 0 <= k <= k0.
double spectral_radius_at(const Case& c, double h) {
  constexpr int modes = 400;
  std::vector<double> x, y, radii(modes);
  for (int i = 1; i <= modes; ++i) {
    const double k = c.modes.k_max * i / modes;
    x.push_back(h * (c.modes.d0 + c.modes.alpha * k));
    y.push_back(h * h * k);
  }
  spectral_radius(c.method, x, y, radii);
  return *std::max_element(radii.begin(), radii.end());
}

// Small random displacements of the linear system at the scene's start. Whether they grow does not depend on
// how small they are.
bool linear_run_diverges(Scene& scene, const State<Vector>& start, const Case& c, double h, long steps,
                         std::uint64_t seed) {
  BlockLinearSystem linear = *scene.linearization(start);
  State<Vector> state{Vector(linear.size()), Vector::Zero(linear.size())};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (double& x : state.x) x = uniform(random);
  const EnergyWatch watch{.initial_energy = linear.potential_energy(state.x), .may_grow = true};
  const auto stepper = c.method.stepper();
  return simulate(linear, *stepper, {h, steps}, watch, state).status != StepStatus::done;
}

bool scene_run_diverges(Subject& subject, const State<Vector>& start, const Case& c, double h,
                        double duration) {
  const auto stepper = c.method.stepper();
  State<Vector> state = start;
  return simulate(subject.system(), *stepper, plan(c.method, h, duration),
                  tightened(subject.energy_watch(start)), state)
             .status != StepStatus::done;
}

// The largest k0(t)/k0(0) of the motion, at 20 times along it.
double k0_growth(Subject& subject, const State<Vector>& start, double k0, double h,
                 const ClothStudyOptions& options) {
  const auto stepper = Method("rk4").stepper();
  State<Vector> state = start;
  double largest = 1, due = 0;
  simulate(subject.system(), *stepper, plan("rk4", h, options.duration), subject.energy_watch(start), state,
           [&](const SimulationResult& so_far, const State<Vector>& s) {
             if (so_far.time < due) return true;
             due += options.duration / 20;
             const StiffestMode now = estimated_stiffest_mode(
                 subject.structure(s).matrices, {.tolerance = k0_tolerance, .seed = options.seed});
             if (now.converged) largest = std::max(largest, now.value / k0);
             return true;
           });
  return largest;
}

// The runs of one method under one damping, which the scene must have by now. k0_growth is left to the
// caller.
ClothStudy study_case(const std::string& name, Subject& subject, const State<Vector>& start, const Case& c,
                      const ClothStudyOptions& options) {
  Scene& scene = *subject.scene();
  ClothStudy study;
  NeededSafety needed{name, c.damping, c.method.name(), c.modes.d0, c.modes.alpha, c.h_limit, 1, {}, {}};
  bool bounded = true;
  for (const double ratio : options.ratios) {
    const double h = ratio * c.h_limit;
    const auto keep = [&](bool linear, long steps, bool diverged) {
      study.runs.push_back({name, c.damping, needed.method, linear, ratio, h, steps, diverged});
    };
    if (!c.method.info().linearized) {  // else the same as the method inside
      const bool diverged = linear_run_diverges(scene, start, c, h, options.linear_steps, options.seed);
      const bool disagrees = diverged != (ratio > 1);
      study.linear_disagreements += disagrees;
      // As for cells: growth that steps enough to pass the watch's threshold would have shown.
      const double band = 2 * std::log(1e6) / static_cast<double>(options.linear_steps);
      study.outside_band += disagrees && std::abs(spectral_radius_at(c, h) - 1) >= band;
      keep(true, options.linear_steps, diverged);
    }
    const bool diverged = scene_run_diverges(subject, start, c, h, options.duration);
    keep(false, plan(c.method, h, options.duration).steps, diverged);
    bounded = bounded && !diverged;
    if (bounded) needed.bounded_ratio = ratio;
  }
  if (needed.bounded_ratio)
    needed.factor = safety_for_step(stability_region(c.method), c.modes,
                                    std::min(1.0, *needed.bounded_ratio) * c.h_limit, most_safety);
  study.needed.push_back(needed);
  return study;
}

// What of a case is not known before it runs.
Json json_of(const ClothStudy& study) {
  Json runs = Json::array();
  for (const ClothRun& r : study.runs)
    runs.push_back(
        {{"linear", r.linear}, {"ratio", r.ratio}, {"h", r.h}, {"steps", r.steps}, {"diverged", r.diverged}});
  const NeededSafety& needed = study.needed.front();
  return {{"runs", runs},
          {"k0_growth", needed.k0_growth},
          {"bounded_ratio", number(needed.bounded_ratio)},
          {"factor", number(needed.factor)},
          {"linear_disagreements", study.linear_disagreements},
          {"outside_band", study.outside_band}};
}

void append(ClothStudy& study, const std::string& name, const Case& c, const Json& one) {
  const std::string method(c.method.name());
  for (const Json& r : one.at("runs"))
    study.runs.push_back(
        {name, c.damping, method, r.at("linear"), r.at("ratio"), r.at("h"), r.at("steps"), r.at("diverged")});
  const auto optional = [&](const char* key) {
    return one.at(key).is_null() ? std::nullopt : std::optional<double>(one.at(key));
  };
  study.needed.push_back({name, c.damping, method, c.modes.d0, c.modes.alpha, c.h_limit, one.at("k0_growth"),
                          optional("bounded_ratio"), optional("factor")});
  study.linear_disagreements += one.at("linear_disagreements").get<long>();
  study.outside_band += one.at("outside_band").get<long>();
}

}  // namespace

ClothStudy study_cloth(const std::string& name, Subject& subject, const ClothStudyOptions& options,
                       const std::function<void(double)>& report, Journal& journal) {
  Scene& scene = *subject.scene();
  const State<Vector> start = subject.initial_state(options.seed);
  const double k0 = stiffest_mode(subject.structure(start).matrices, {.seed = options.seed}).value;
  ClothStudy study;
  const std::vector<Case> all = cases(k0, options.methods);
  for (const Case& c : all) {
    append(study, name, c, journal.piece(name + ", " + c.damping + ", " + c.method.name(), [&] {
      scene.set_damping({c.modes.d0, c.modes.alpha});
      scene.set_hessian(c.method.info().linearized ? Hessian::projected : Hessian::exact);
      const bool known = !study.needed.empty() && study.needed.back().damping == c.damping;
      const double growth =
          known ? study.needed.back().k0_growth : k0_growth(subject, start, k0, 0.5 * c.h_limit, options);
      ClothStudy one = study_case(name, subject, start, c, options);
      one.needed.front().k0_growth = growth;
      return json_of(one);
    }));
    report(static_cast<double>(study.needed.size()) / static_cast<double>(all.size()));
  }
  return study;
}

}  // namespace springstab
