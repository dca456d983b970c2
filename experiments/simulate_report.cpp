#include "experiments/simulate_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "experiments/contact_report.h"
#include "experiments/inputs/mesh_report.h"
#include "experiments/inputs/size_report.h"

namespace springstab {
namespace {

// What is told of a gain: from this part of the energy turned over on, and from this speed of all that moves.
constexpr double told_gain = 0.01, told_speed = 1e-9;  // [m/s]

double energy_of(const State<Vector>& state, System& system) {
  return system.kinetic_energy(state.v) + system.potential_energy(state.x);
}

// Kinetic, elastic and gravity's potential energy together never grow by themselves [J]; obstacles in motion
// give.
double gained(const Course& course, System& system) {
  const double given = course.contact ? std::max(course.contact->obstacle_work, 0.) : 0;
  return std::max(energy_of(course.end, system) - energy_of(course.start, system) - given, 0.);
}

// What passed from one kind of energy to another, at the end against the start [J].
double turned_over(const Course& course, System& system) {
  return system.kinetic_energy(course.end.v) + system.kinetic_energy(course.start.v) +
         std::abs(system.potential_energy(course.end.x) - system.potential_energy(course.start.x));
}

void print_end(const Course& course, const SimulateOptions& options) {
  const SimulationResult& result = course.result;
  std::cout << text("%s, %ld steps of %.6g s in %.3g CPU-seconds: ", options.method.c_str(), result.steps,
                    course.step, course.cpu_seconds);
  if (course.stopped) {
    std::cout << text("interrupted at t = %.6g s\n", result.time);
  } else if (course.diverged()) {
    std::cout << text("diverged at t = %.6g s\n", result.failed_at);
  } else if (course.contact && course.contact->surfaces && course.contact->surfaces->blocked > 0) {
    std::cout << text("stopped at t = %.6g s, obstacles left the cloth no way\n", result.time);
  } else if (result.status != StepStatus::done) {
    std::cout << text("stopped at t = %.6g s, the linear system was %s\n", result.time,
                      outcome(result.status));
  } else {
    std::cout << "done\n";
  }
}

void print_decisions(const StepDecisions& decisions, bool linearized) {
  if (decisions.rollbacks > 0)
    std::cout << text("divergence was seen and undone %ld times; the last step was %.6g s%s\n",
                      decisions.rollbacks, decisions.h,
                      linearized ? text(", linearized every %.6g s", decisions.relinearize).c_str() : "");
  if (decisions.halved_steps > 0)
    std::cout << text("%ld steps were halved because 1 + hD' + h²K' was not positive definite\n",
                      decisions.halved_steps);
}

}  // namespace

const char* outcome(StepStatus status) {
  switch (status) {
    case StepStatus::done:
      return "done";
    case StepStatus::diverged:
      return "diverged";
    case StepStatus::not_positive_definite:
      return "not positive definite";
    case StepStatus::not_converged:
      break;
  }
  return "not converged";
}

Json json_of(const Course& course, const SimulateOptions& options, Subject& subject,
             const StepChooser& chooser, int frames) {
  System& system = subject.system();
  const auto energy = [&](const State<Vector>& s) { return number(energy_of(s, system)); };
  const bool linearized = Method(options.method).info().linearized;
  const StepDecisions& decisions = chooser.decisions();
  Json report{{"method", options.method},
              {"status", course.stopped ? "interrupted" : outcome(course.result.status)},
              {"step", course.step},
              {"steps", course.result.steps},
              {"diverged", course.diverged()},
              {"diverged_at", course.diverged() ? number(course.result.failed_at) : Json()},
              {"grows", course.grows(system)},
              {"last_step", decisions.h},
              {"last_relinearize", linearized ? Json(decisions.relinearize) : Json()},
              {"cpu_seconds", course.cpu_seconds},
              {"counts",
               {{"force_evaluations", course.counts.force_evaluations},
                {"hessian_assemblies", course.counts.hessian_assemblies},
                {"block_products", course.counts.block_products},
                {"cg_iterations", course.counts.cg_iterations},
                {"relinearizations", linearized ? course.counts.hessian_assemblies : 0},
                {"rollbacks", decisions.rollbacks},
                {"halved_steps", decisions.halved_steps}}},
              {"energy",
               {{"initial", energy(course.start)},
                {"final", energy(course.end)},
                {"gained", number(gained(course, system))}}},
              {"frames", frames},
              {"mesh", mesh_json(subject)}};
  if (course.contact) add_contact(report, *course.contact);
  report["damping"] = {{"d0", number(subject.damping().d0)}, {"alpha", number(subject.damping().alpha)}};
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d last = scene->positions(course.end.x).back();
    report["last_particle"] = {{"position", {last.x(), last.y(), last.z()}}};
    report["solver"] = options.direct ? "direct" : "cg";
    report["cg_tolerance"] = options.direct ? Json() : Json(options.cg_tolerance);
  }
  add_size(report, subject);
  return report;
}

void print_report(const Course& course, const SimulateOptions& options, Subject& subject,
                  const StepChooser& chooser, int frames) {
  System& system = subject.system();
  print_end(course, options);
  print_decisions(chooser.decisions(), Method(options.method).info().linearized);
  if (subject.scene()) std::cout << size_text(subject) << '\n';
  std::cout << text("energy %.6g J at the start, %.6g J at the end\n", energy_of(course.start, system),
                    energy_of(course.end, system));
  if (course.grows(system)) {
    std::cout << "the structure is unstable: its motion grows by itself\n";
  } else if (const double gain = gained(course, system);
             gain > std::max(told_gain * turned_over(course, system),
                             course.watch.mass * told_speed * told_speed / 2)) {
    std::cout << text("the run gained %.3g J beyond what gravity can give: the step is too long\n", gain);
  }
  if (Scene* scene = subject.scene()) {
    const Eigen::Vector3d p = scene->positions(course.end.x).back();
    std::cout << text("last particle at (%.9g, %.9g, %.9g) m\n", p.x(), p.y(), p.z());
  }
  if (course.contact) std::cout << contact_text(*course.contact, chooser.decisions().h);
  if (frames > 0) std::cout << text("%d frames in %s\n", frames, options.output.c_str());
}

}  // namespace springstab
