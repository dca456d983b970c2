// `springstab methods`: what each method is, all of it computed from its step.
#include <cmath>
#include <iostream>
#include <memory>

#include "analysis/regions/stability_region.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/command/subcommand_list.h"
#include "solvers/counting.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

// Force evaluations of one step, counted.
long force_evaluations(const Method& method) {
  SparseMatrix one(1, 1);
  one.setIdentity();
  MatrixSystem oscillator(prepare(one));
  CountingSystem counting(oscillator);
  State<Vector> state{Vector::Ones(1), Vector::Zero(1)};
  const auto stepper = method.stepper();
  stepper->start(counting, 0.1, state);
  const long before = counting.counts().force_evaluations;
  stepper->step(counting, 0.1, state);
  return counting.counts().force_evaluations - before;
}

int run_methods(const CommonOptions& common, const std::string& names) {
  Json list = Json::array();
  if (!common.json)
    std::cout << text("%-26s %5s %6s %9s %14s %14s %9s %12s %12s\n", "method", "order", "forces", "implicit",
                      "Y_max", "at X", "attained", "real axis", "imag. axis");
  for (const Method& each : methods_of(names)) {
    const RegionConstants& c = stability_region(each).constants();
    const bool bounded = std::isfinite(c.x_at_y_max);
    list.push_back({{"name", each.name()},
                    {"title", each.info().title},
                    {"order", each.info().order},
                    {"force_evaluations", force_evaluations(each)},
                    {"implicit", each.info().implicit},
                    {"y_max", number(c.y_max)},
                    {"x_at_y_max", bounded ? number(c.x_at_y_max) : Json()},
                    {"y_max_attained", c.y_max_attained},
                    {"real_interval", number(c.real_interval)},
                    {"imaginary_interval", number(c.imaginary_interval)}});
    if (!common.json)
      std::cout << text("%-26s %5d %6ld %9s %14.11g %14s %9s %12.10g %12.10g\n", each.name().c_str(),
                        each.info().order, force_evaluations(each), each.info().implicit ? "yes" : "no",
                        c.y_max, bounded ? text("%.11g", c.x_at_y_max).c_str() : "-",
                        c.y_max_attained ? "yes" : "no", c.real_interval, c.imaginary_interval);
  }
  if (common.json) {
    print_json(Json{{"methods", list}});
  } else {
    std::cout << "\nY = h²k and X = hd of one mode. Explicit Euler with damping α = h takes the same steps "
                 "as symplectic\n"
                 "Euler without it: the damping that stabilizes it damps nothing.\n"
              << leapfrog_words << '\n';
  }
  return done;
}

}  // namespace

Subcommand methods_command() {
  const auto names = std::make_shared<std::string>();
  return {.name = "methods",
          .title = "The methods and their constants",
          .footer =
              "Y_max: largest stable Y = h^2 k over all damping, and the X = h d where it is; real axis: "
              "largest\n"
              "stable X at Y = 0; imaginary axis: largest stable h*sqrt(k) without damping.\n" +
              std::string(leapfrog_words) +
              "\n\n"
              "examples: springstab methods --json\n"
              "          springstab methods --methods all",
          .options = {methods_option(*names)},
          .run = [names](const CommonOptions& common) { return run_methods(common, *names); }};
}

}  // namespace springstab
