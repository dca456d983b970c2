// `springstab probe`: another program's integrator, asked for steps: how large they may be, and of which
// method.
#include <cmath>
#include <iostream>
#include <memory>

#include "analysis/spectra/step_map.h"
#include "experiments/child_program.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/command/subcommand_list.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

struct ProbeOptions {
  std::vector<std::string> command;
  std::string claims, state;
  std::optional<int> size;
  double timeout = 10, difference = 1e-6, first_step = 1e-3;
};

void check(const ProbeOptions& options) {
  const auto positive = [](const char* option, double value) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(option, 0, text("is %g, expected a positive number", value));
  };
  positive("--timeout", options.timeout);
  positive("--difference", options.difference);
  positive("--first-step", options.first_step);
  if (options.size.has_value() == !options.state.empty())
    throw InputError("--size, --state", 0, "expected one of them: how many unknowns, or where they are");
  if (options.size && (*options.size < 1 || *options.size > step_map_limit))
    throw InputError("--size", 0,
                     text("is %d, expected 1 to %ld", *options.size, static_cast<long>(step_map_limit)));
}

// The array of that name; null, as JavaScript writes NaN, is none of its numbers.
Vector vector_of(const Json& object, const char* name, const std::string& source) {
  if (!object.is_object() || !object.contains(name) || !object[name].is_array())
    throw InputError(source, 0, text("no array \"%s\", expected {\"x\": [...], \"v\": [...]}", name));
  const Json& list = object[name];
  Vector values(static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number() || !std::isfinite(list[i].get<double>()))
      throw InputError(source, 0,
                       text("%s[%zu] is %s, expected a finite number", name, i, list[i].dump().c_str()));
    values[static_cast<Eigen::Index>(i)] = list[i].get<double>();
  }
  return values;
}

Json parsed(const std::string& line, const std::string& source) {
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded())
    throw InputError(source, 0,
                     "'" + line.substr(0, 60) + "' is no JSON, expected {\"x\": [...], \"v\": [...]}");
  return json;
}

Json json_of(const Vector& values) { return Json(std::vector<double>(values.begin(), values.end())); }

StepMap map_of(ChildProgram& program, Eigen::Index size) {
  return {size, [&program, size](double h, Vector& x, Vector& v) {
            const std::string line = program.ask(Json{{"h", h}, {"x", json_of(x)}, {"v", json_of(v)}}.dump());
            const std::string source = program.source();
            const Json answer = parsed(line, source);
            x = vector_of(answer, "x", source);
            v = vector_of(answer, "v", source);
            if (x.size() != size || v.size() != size)
              throw InputError(
                  source, 0,
                  text("x and v have %ld and %ld entries, expected %ld", static_cast<long>(x.size()),
                       static_cast<long>(v.size()), static_cast<long>(size)));
          }};
}

std::vector<Method> known_methods(const std::string& claims) {
  std::vector<Method> methods = built_in_methods();
  if (!claims.empty() && std::ranges::find(methods, Method(claims)) == methods.end())
    methods.emplace_back(claims);
  return methods;
}

struct Finding {
  LargestStep largest;
  std::vector<MethodFit> fits;
  const MethodFit* compared = nullptr;  // the claimed one, else the one that fits
};

const MethodFit* compared(const Finding& found, const std::string& claims) {
  if (claims.empty())
    return !found.fits.empty() && found.fits[0].distance < same_eigenvalues ? &found.fits[0] : nullptr;
  const auto of_claim = std::ranges::find(found.fits, Method(claims), &MethodFit::method);
  if (of_claim == found.fits.end())
    throw InputError("--claims", 0,
                     claims + " solves systems whose eigenvalues are not those of single modes");
  return &*of_claim;
}

std::optional<double> ratio(const Finding& found) {
  if (!found.compared || !found.compared->h_max || !found.largest.h_max) return std::nullopt;
  const double of = *found.compared->h_max, it = *found.largest.h_max;
  return std::isfinite(it) && std::isfinite(of) && of > 0 ? std::optional(it / of) : std::nullopt;
}

Json report(const Finding& found, const std::string& claims) {
  Json fits = Json::array();
  for (const MethodFit& fit : found.fits)
    fits.push_back(
        {{"method", fit.method.name()}, {"distance", number(fit.distance)}, {"h_max", number(fit.h_max)}});
  const bool fit = !found.fits.empty() && found.fits[0].distance < same_eigenvalues;
  Json json{
      {"h_max", number(found.largest.h_max)},
      {"leaves_at", {found.largest.leaves_at.real(), found.largest.leaves_at.imag()}},
      {"method_that_fits", fit ? Json(found.fits[0].method.name()) : Json()},
      {"claims", claims.empty() ? Json() : Json(claims)},
      {"is_what_it_claims", claims.empty() ? Json() : Json(found.compared->distance < same_eigenvalues)},
      {"ratio", number(ratio(found))},
      {"fits", fits}};
  return json;
}

void print(const Finding& found, const std::string& claims) {
  const LargestStep& l = found.largest;
  if (!l.h_max) {
    std::cout << "no stable step: some motion grows with the smallest steps that were tried\n";
  } else if (std::isinf(*l.h_max)) {
    std::cout << "no step that was tried is unstable\n";
  } else {
    std::cout << text(
        "largest stable step %.8g s; beyond it the eigenvalue %.4g%+.4gi leaves the unit disk\n", *l.h_max,
        l.leaves_at.real(), l.leaves_at.imag());
  }
  if (!found.fits.empty())
    std::cout << text(
        "%s %s, whose eigenvalues are at most %.2g away\n",
        found.fits[0].distance < same_eigenvalues ? "its steps are those of" : "no method fits; nearest is",
        found.fits[0].method.name().c_str(), found.fits[0].distance);
  if (!claims.empty())
    std::cout << text("it is %s%s", found.compared->distance < same_eigenvalues ? "" : "not ", claims.c_str())
              << text(" (eigenvalues at most %.2g away)\n", found.compared->distance);
  if (const auto r = ratio(found))
    std::cout << text("%.6g of the largest step of %s for the same forces\n", *r,
                      found.compared->method.name().c_str());
}

int run_probe(const CommonOptions& common, const ProbeOptions& options) {
  check(options);
  if (!options.claims.empty()) Method{options.claims};
  Vector x = Vector::Zero(options.size.value_or(0)), v = x;
  if (!options.state.empty()) {
    const Json state = parsed(read_text_file(options.state), options.state);
    x = vector_of(state, "x", options.state);
    v = state.contains("v") ? vector_of(state, "v", options.state) : Vector(Vector::Zero(x.size()));
  }
  ChildProgram program(options.command, options.timeout);
  const StepMap map = map_of(program, x.size());
  const StepMapOptions how{.difference = options.difference, .first_step = options.first_step};
  Finding found;
  {
    const Waiting waiting("probing", common.quiet);
    found.largest = largest_stable_step(map, x, v, how);
    found.fits = methods_that_fit(map, x, v, known_methods(options.claims), how);
  }
  found.compared = compared(found, options.claims);
  if (common.json) {
    print_json(report(found, options.claims));
  } else {
    print(found, options.claims);
  }
  return found.largest.h_max ? done : no_answer;
}

}  // namespace

Subcommand probe_command() {
  const auto o = std::make_shared<ProbeOptions>();
  return {
      .name = "probe",
      .title = "Another program's integrator: its largest stable step, and which method it is",
      .footer =
          "COMMAND is started once. It reads a line {\"h\": 0.01, \"x\": [...], \"v\": [...]} and answers "
          "with "
          "the state a\n"
          "step of h later, {\"x\": [...], \"v\": [...]}, a line for a line, a function of h, x and v alone. "
          "Its "
          "step is linearized\n"
          "by central differences; eigenvalues within 1e-4 of 1 are motions that physics leaves neutral, and "
          "do not count.\n"
          "At most 400 unknowns. ratio is to the largest step of the method that it claims to be, else of "
          "the "
          "one that fits.\n"
          "Exit status 3: no step is stable.\n\n"
          "example: springstab probe --claims rk4 --size 6 -- python3 my_engine.py",
      .options =
          {Option("COMMAND", &o->command, "the program and its arguments, after --").needed().shown_as(""),
           Option("--claims", &o->claims, "the method that it is meant to be").shown_as("METHOD"),
           Option("--size", &o->size, "unknowns; linearized at x = v = 0").shown_as("N"),
           Option("--state", &o->state, "where to linearize: {\"x\": [...], \"v\": [...]}").shown_as("FILE"),
           Option("--timeout", &o->timeout, "for each answer, in seconds").with_default(),
           Option("--difference", &o->difference, "displacement relative to the largest entry of x")
               .with_default(),
           Option("--first-step", &o->first_step, "tried first, in seconds").with_default()},
      .run = [o](const CommonOptions& common) { return run_probe(common, *o); }};
}

}  // namespace springstab
