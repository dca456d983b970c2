#include "experiments/for_step_report.h"

#include <cmath>
#include <map>
#include <ostream>

#include "solvers/io/input_error.h"

namespace springstab {
namespace {

template <class Value, class Shown>
void add_found(const char* key, const Found<Value>& found, const Shown& as_json, Json& json) {
  json[key] = found.value ? Json(as_json(*found.value)) : Json();
  if (!found.value) json["reasons"][key] = found.reason;
}

Json shown_scaling(const MassScaling& scaling, const std::vector<long>& numbers) {
  Json particles = Json::array();
  for (const auto& [particle, mass] : scaling.particles)
    particles.push_back(
        {{"index", numbers[static_cast<std::size_t>(particle)]}, {"added_mass", number(mass)}});
  return {{"particles", particles},
          {"added_mass", number(scaling.added_mass)},
          {"least_added_mass", number(scaling.least)},
          {"proved", scaling.proved}};
}

Json answer_json(const StepAnswer& answer, double step, const std::vector<long>& numbers) {
  Json json{{"step", step},
            {"holds", answer.holds ? Json(*answer.holds) : Json()},
            {"margin", number(answer.margin)},
            {"proved", answer.proved},
            {"reason", answer.holds ? Json() : Json(answer.unknown)}};
  if (answer.holds != false) return json;
  const auto plain = [](double value) { return number(value); };
  add_found("stiffness_factor", answer.stiffness_factor, plain, json);
  add_found(
      "alpha", answer.alpha,
      [](const AlphaRange& range) {
        return Json{number(range.low), number(range.high)};
      },
      json);
  add_found("uniform_mass_factor", answer.mass_factor, plain, json);
  add_found(
      "mass_scaling", answer.mass_scaling,
      [&](const MassScaling& scaling) { return shown_scaling(scaling, numbers); }, json);
  add_found(
      "substeps", answer.substeps, [](long n) { return n; }, json);
  return json;
}

std::string cell_of(const Found<double>& found) { return found.value ? text("%.6g", *found.value) : "-"; }

std::string cell_of(const Found<AlphaRange>& found) {
  return found.value ? text("%.4g to %.4g", found.value->low, found.value->high) : "-";
}

std::string cell_of(const Found<MassScaling>& found) {
  if (!found.value) return "-";
  return text("%.4g to %zu%s", found.value->added_mass, found.value->particles.size(),
              found.value->proved ? "" : ", not proved");
}

std::string verdict_on(const StepAnswer& answer) {
  if (!answer.holds) return "unknown";
  return !*answer.holds ? "no" : answer.proved ? "proved" : "yes";
}

using Reasons = std::map<std::string, std::string>;  // what is not answered, and why: of which methods

template <class Value>
void add_reason(const std::string& what, const Found<Value>& found, const std::string& method,
                Reasons& reasons) {
  if (found.value) return;
  std::string& list = reasons[what + ": " + std::string(found.reason)];
  list += (list.empty() ? "" : ", ") + method;
}

std::optional<double> wanted_step(const LimitsOptions& options) {
  if (options.substeps > 0 && options.frame_rate) return 1 / (*options.frame_rate * options.substeps);
  return options.for_step;
}

}  // namespace

void check_for_step(const CommonOptions& common, const LimitsOptions& options) {
  if (options.for_step && !(*options.for_step > 0 && std::isfinite(*options.for_step)))
    throw InputError("--for-step", 0,
                     text("is %g, expected a positive number of seconds", *options.for_step));
  if (!common.given.contains("--substeps")) return;
  if (options.substeps < 1)
    throw InputError("--substeps", 0, text("is %d, expected a number from 1", options.substeps));
  if (options.for_step) throw InputError("--for-step, --substeps", 0, "are both given, expected one of them");
  if (!options.frame_rate)
    throw InputError("--substeps", 0, "is for a frame, expected --frame-rate beside it");
}

ForStepReport::ForStepReport(const LimitsOptions& options, StructureLimits& answer,
                             std::span<const Method> methods, const Subject& subject, Waiting& waiting)
    : step_(wanted_step(options)), particles_(subject.scene() ? "particles" : "unknowns") {
  if (!step_) return;
  numbers_ = subject.particle_numbers();
  ForStep question(answer, *step_, subject.unknowns_a_particle());
  for (const Method& method : methods) {
    waiting.now("what would make " + method.name() + " hold");
    rows_.push_back({method.name(), question.of(method)});
  }
}

void ForStepReport::add_to(Json& json) const {
  if (!step_) return;
  json["for_step"] = Json::object();
  for (const auto& [method, answer] : rows_) json["for_step"][method] = answer_json(answer, *step_, numbers_);
}

void ForStepReport::print(std::ostream& out) const {
  if (!step_) return;
  out << text("\nat a step of %.6g s\n%-26s %-10s %12s\n", *step_, "method", "holds", "h_max/step");
  bool changes = false;
  std::map<std::string_view, std::string> unknown;
  for (const auto& [method, answer] : rows_) {
    out << text("%-26s %-10s %12s\n", method.c_str(), verdict_on(answer).c_str(),
                answer.margin ? text("%.6g", *answer.margin).c_str() : "-");
    changes = changes || answer.holds == false;
    if (answer.holds) continue;
    std::string& list = unknown[answer.unknown];
    list += (list.empty() ? "" : ", ") + method;
  }
  for (const auto& [reason, list] : unknown) out << "\nnot known, " << reason << ": " << list << '\n';
  if (changes) print_changes(out);
}

void ForStepReport::print_changes(std::ostream& out) const {
  out << text("\nwhat alone would make it hold; d0, alpha and dampers stay\n%-26s %12s %24s %12s %24s %9s\n",
              "method", "stiffness x", "alpha [s]", "mass x", text("kg to %s", particles_).c_str(),
              "substeps");
  Reasons reasons;
  for (const auto& [method, answer] : rows_) {
    if (answer.holds != false) continue;
    out << text("%-26s %12s %24s %12s %24s %9s\n", method.c_str(), cell_of(answer.stiffness_factor).c_str(),
                cell_of(answer.alpha).c_str(), cell_of(answer.mass_factor).c_str(),
                cell_of(answer.mass_scaling).c_str(),
                answer.substeps.value ? text("%ld", *answer.substeps.value).c_str() : "-");
    add_reason("stiffness", answer.stiffness_factor, method, reasons);
    add_reason("alpha", answer.alpha, method, reasons);
    add_reason("mass", answer.mass_factor, method, reasons);
    add_reason("kg", answer.mass_scaling, method, reasons);
    add_reason("substeps", answer.substeps, method, reasons);
  }
  for (const auto& [reason, list] : reasons) out << '\n' << reason << ": " << list << '\n';
}

}  // namespace springstab
