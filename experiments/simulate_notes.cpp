#include "experiments/simulate_notes.h"

#include <iostream>

#include "analysis/method.h"
#include "experiments/inputs/size_report.h"

namespace springstab {

void print_unused_options(const CommonOptions& common, const SimulateOptions& options, bool matrices) {
  const MethodInfo& method = Method(options.method).info();
  const auto unused = [&](const char* option, bool useless, const std::string& reason) {
    const bool told = useless && common.given.contains(option);
    if (told) std::cerr << "springstab: note: " << option << " has no use here: " << reason << '\n';
    return told;
  };
  const std::string& name = options.method;
  unused("--relinearize", !method.linearized, name + " freezes no forces");
  unused("--hessian", !method.linearized && !method.implicit, name + " takes its steps without K");
  const bool solves = method.implicit && method.implicit_damping != DampingPart::diagonal;
  unused("--solver", !solves, name + " solves no linear system");
  unused("--cg-tolerance", !solves, name + " solves no linear system") ||
      unused("--cg-tolerance", matrices, "systems of matrices are solved directly") ||
      unused("--cg-tolerance", options.direct, "--solver direct is exact");
  unused("--newton", !method.implicit, name + " solves no equations") ||
      unused("--newton", matrices, "one Newton step solves linear equations") ||
      unused("--newton", !Method(name).stepper()->set_newton({}), name + " takes the rest explicitly");
  unused("--safety", options.step.has_value(), "--step is given");
  for (const char* option : {"--format", "--frames"})
    unused(option, options.output.empty(), "without --output nothing is written");
  unused("--format", matrices && !options.output.empty(), "matrices write trajectory.csv");
}

void print_step_warning(Subject& subject, const State<Vector>& start, double step) {
  const std::string what = exceeded(step, time_scales(subject, slowest_period(subject, start)));
  if (!what.empty())
    std::cerr << text("springstab: warning: the step of %.4g s exceeds %s: too long to follow the motion\n",
                      step, what.c_str());
}

}  // namespace springstab
