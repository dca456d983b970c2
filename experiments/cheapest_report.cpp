#include "experiments/cheapest_report.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr double least_budget = 1e-3, budget_share = 0.01;  // a method: [s], of the limits' own CPU time

std::string times(double factor) { return text("%.3g times as", factor); }

// Against the one that costs next to least.
std::string comparison(const MethodCost& best, const MethodCost& second) {
  const double dearer = *second.cpu_per_step / *best.cpu_per_step, longer = second.step / best.step;
  const std::string& name = second.method.name();
  if (longer > 1)
    return "a step of " + name + " is " + times(longer) + " long, but costs " + times(dearer) + " much";
  if (dearer > 1)
    return "its step is no shorter than that of " + name + ", which costs " + times(dearer) + " much";
  return "its step costs " + times(1 / dearer) + " much as one of " + name + ", but is " + times(1 / longer) +
         " long";
}

std::string none_reason(const CheapestMethod& cheapest, const CheapestOptions& options) {
  if (!options.error) return "no step is known to be stable";
  if (!cheapest.motion()) return "errors are predicted from modes, which this structure has not";
  return "no stable step is known to reach this error";
}

// What the error is one of.
std::string error_of(const CheapestMethod& cheapest) {
  std::string all = cheapest.motion()->at_rest
                        ? "nothing moves at the start: of the motion after a push, all accelerations alike"
                        : "of the linear system's motion from the start";
  if (cheapest.motion()->damping.kind == DampingModel::Kind::general)
    all += ", damped mode by mode: what D couples is left out";
  return all;
}

void print_frames(std::ostream& out, StructureLimits& answer, std::span<const Method> methods, double rate) {
  std::string list;
  for (const Method& method : methods) {
    const std::optional<double> largest = answer.limits(method).recommended;
    if (!largest) continue;
    const Substeps substeps = substeps_of_frame(rate, *largest);
    list +=
        (list.empty() ? "" : ", ") + method.name() + text(" %ld of %.6g s", substeps.number, substeps.step);
  }
  if (!list.empty()) out << text("\nsubsteps of a frame at %g a second: ", rate) << list << '\n';
}

}  // namespace

void check_error(const std::optional<double>& error) {
  if (error && !(*error > 0 && *error < 1))
    throw InputError("--error", 0, text("is %g, expected more than 0 and less than 1", *error));
}

void check_cheapest(const LimitsOptions& options) {
  check_error(options.error);
  if (options.frame_rate && !(*options.frame_rate > 0 && std::isfinite(*options.frame_rate)))
    throw InputError("--frame-rate", 0,
                     text("is %g, expected a positive number of frames a second", *options.frame_rate));
}

CheapestOptions cheapest_options(const LimitsOptions& options, double limits_seconds) {
  return {.error = options.error,
          .frame_rate = options.frame_rate,
          .budget = std::max(least_budget, budget_share * limits_seconds)};
}

std::string reason(const CheapestMethod& cheapest, const CheapestOptions& options) {
  const MethodCost* const best = cheapest.best();
  if (!best) return none_reason(cheapest, options);
  std::string all;
  if (best->error)
    all = best->by_stability ? "stability limits its step, not the error; " : "the error limits its step; ";
  return all +
         (cheapest.second() ? comparison(*best, *cheapest.second()) : "no other method has such a step");
}

Json cheapest_json(const CheapestMethod& cheapest, const CheapestOptions& options) {
  const MethodCost* const best = cheapest.best();
  Json json{{"method", best ? Json(best->method.name()) : Json()},
            {"step", best ? number(best->step) : Json()},
            {"cpu_seconds_per_second", best ? number(best->cost()) : Json()},
            {"error", best ? number(best->error) : Json()},
            {"reason", reason(cheapest, options)}};
  if (!options.error || !cheapest.motion()) return json;
  json["error_over"] = cheapest.duration();
  json["error_of"] = error_of(cheapest);
  return json;
}

void add_steps(Json& json, const CheapestMethod& cheapest, const Method& method, const MethodLimits& limits,
               const CheapestOptions& options) {
  if (options.frame_rate) {
    const auto of_frame = limits.recommended
                              ? std::optional(substeps_of_frame(*options.frame_rate, *limits.recommended))
                              : std::nullopt;
    json["substeps"] = of_frame ? Json(of_frame->number) : Json();
    json["frame_step"] = of_frame ? number(of_frame->step) : Json();
  }
  if (options.error) {
    const MethodCost* const found = cheapest.find(method);
    json["error_step"] = found ? number(found->step) : Json();
    json["predicted_error"] = found ? number(found->error) : Json();
  }
}

void print_cheapest(std::ostream& out, const CheapestMethod& cheapest, StructureLimits& answer,
                    std::span<const Method> methods, const CheapestOptions& options) {
  const MethodCost* const best = cheapest.best();
  if (options.frame_rate) print_frames(out, answer, methods, *options.frame_rate);
  out << "\ncheapest";
  if (options.error) out << text(" for an error of %g", *options.error);
  if (options.error && cheapest.motion())
    out << text(" over %.4g s (", cheapest.duration()) << error_of(cheapest) << ")";
  out << ": ";
  if (best) {
    out << best->method.name() << text(" at %.6g s, ", best->step);
    if (best->error) out << text("error %.3g, ", *best->error);
    out << text("%.3g CPU-seconds a second: ", *best->cost());
  } else {
    out << "none, ";
  }
  out << reason(cheapest, options) << '\n';
}

}  // namespace springstab
