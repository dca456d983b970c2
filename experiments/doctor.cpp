// `springstab doctor`: what this command was built with, what it finds on this machine, and whether a few
// limits that are known in closed form come out.
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <thread>

#include "analysis/structure_limits.h"
#include "experiments/command/optional_parts.h"
#include "experiments/command/output.h"
#include "experiments/command/programs.h"
#include "experiments/command/shared_options.h"
#include "experiments/runs/measured_run.h"

namespace springstab {
namespace {

constexpr double known_to = 1e-9;  // relative

/// A number that is known, and what came out.
struct KnownCase {
  std::string name;
  double expected;
  std::optional<double> found;

  bool holds() const { return found && std::abs(*found - expected) <= known_to * std::abs(expected); }
};

// n masses of 1 kg between two walls, joined by springs of 1 N/m: k0 = 4 sin²(nπ / (2(n + 1))).
SparseMatrix chain_stiffness(int n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.);
    if (i > 0) {
      entries.emplace_back(i, i - 1, -1.);
      entries.emplace_back(i - 1, i, -1.);
    }
  }
  SparseMatrix k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

void add_chain(int n, std::vector<KnownCase>& cases) {
  StructureLimits answer(structure_of(prepare(chain_stiffness(n))));
  const double rate = 2 * std::sin(n * std::numbers::pi / (2. * (n + 1)));  // √k0
  const std::string chain = text("a chain of %d masses: ", n);
  cases.push_back({chain + "k0", rate * rate, answer.k0().value});
  cases.push_back({chain + "h_max of symplectic-euler", 2 / rate, answer.limits("symplectic-euler").h_max});
  cases.push_back({chain + "h_max of rk4", 2 * std::numbers::sqrt2 / rate, answer.limits("rk4").h_max});
  // Proved, and within a thousandth.
  const std::optional<double> proved = answer.limits("rk4").h_certified;
  const double limit = 2 * std::numbers::sqrt2 / rate;
  const bool near = proved && *proved <= limit * (1 + known_to) && *proved >= 0.998 * limit;
  cases.push_back({chain + "rk4's certified step, of h_max at most and nearly", 1, near ? 1. : 0.});
  cases.push_back({chain + "no step of explicit-euler", 1,
                   answer.limits("explicit-euler").status == LimitStatus::none ? 1. : 0.});
}

std::vector<KnownCase> known_cases() {
  std::vector<KnownCase> cases{
      {"rk2: largest Y", 2 + 2 * std::numbers::sqrt2, stability_region("rk2").constants().y_max},
      {"rk4: imaginary interval", 2 * std::numbers::sqrt2,
       stability_region("rk4").constants().imaginary_interval},
      {"symplectic-euler: largest Y", 4, stability_region("symplectic-euler").constants().y_max}};
  add_chain(20, cases);   // all eigenvalues
  add_chain(300, cases);  // ARPACK
  return cases;
}

Json program_json(const char* name, const char* purpose, const std::optional<std::string>& path) {
  return {{"name", name}, {"purpose", purpose}, {"path", path ? Json(*path) : Json()}};
}

Json doctors_report() {
  Json parts = Json::array(), checks = Json::array();
  for (const OptionalPart& part : optional_parts())
    parts.push_back({{"name", part.name}, {"purpose", part.purpose}, {"built_in", part.built_in}});
  bool sound = true;
  for (const KnownCase& each : known_cases()) {
    sound = sound && each.holds();
    checks.push_back({{"name", each.name},
                      {"expected", number(each.expected)},
                      {"found", number(each.found)},
                      {"holds", each.holds()}});
  }
  return {{"build", provenance()},
          {"cores", std::thread::hardware_concurrency()},
          {"parts", parts},
          {"programs",
           {program_json("gnuplot", "figures, report, pictures", find_program("gnuplot")),
            program_json("Chromium", "report --pdf", find_browser())}},
          {"plots", plots_folder()},
          {"checks", checks},
          {"sound", sound}};
}

void print_doctor(const Json& report) {
  std::cout << report["build"].get<std::string>() << text("\n%u cores\n\n", report["cores"].get<unsigned>());
  for (const Json& part : report["parts"])
    std::cout << text("%-28s %-14s for %s\n", part["name"].get<std::string>().c_str(),
                      part["built_in"].get<bool>() ? "built in" : "not built in",
                      part["purpose"].get<std::string>().c_str());
  for (const Json& program : report["programs"])
    std::cout << text("%-28s %-14s for %s\n", program["name"].get<std::string>().c_str(),
                      program["path"].is_null() ? "not found" : program["path"].get<std::string>().c_str(),
                      program["purpose"].get<std::string>().c_str());
  std::cout << "gnuplot's scripts             " << report["plots"].get<std::string>() << "\n\n";
  for (const Json& each : report["checks"])
    if (!each["holds"].get<bool>())
      std::cout << "wrong: " << each["name"].get<std::string>()
                << text(" is %s, expected %.12g\n", each["found"].dump().c_str(),
                        each["expected"].get<double>());
  std::cout << (report["sound"].get<bool>()
                    ? text("sound: all of %zu known numbers come out\n", report["checks"].size())
                    : "not sound: do not trust this build's answers\n");
}

int run_doctor(const CommonOptions& common) {
  const Json report = doctors_report();
  if (common.json) {
    print_json(report);
  } else {
    print_doctor(report);
  }
  return report["sound"].get<bool>() ? done : internal_error;
}

}  // namespace

Subcommand doctor_command() {
  return {
      .name = "doctor",
      .title = "What is built in and installed, and whether known limits come out",
      .footer =
          "Exit status 1: a number that is known in closed form comes out otherwise. JSON: build, cores,\n"
          "parts[] {name, built_in}, programs[] {name, path}, plots, checks[] {name, expected, found, "
          "holds}, sound.\n\n"
          "example: springstab doctor",
      .options = {},
      .run = run_doctor};
}

}  // namespace springstab
