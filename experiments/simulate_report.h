// What a run of `simulate` came to, for people and for programs.
#pragma once

#include "analysis/limits/step_policy.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/simulate_options.h"
#include "solvers/counting.h"
#include "solvers/simulation.h"

namespace springstab {

// What a run came to.
struct Course {
  SimulationResult result;
  State<Vector> start, end;
  EnergyWatch watch;
  Counts counts;
  std::optional<ContactCounts> contact{};
  double cpu_seconds = 0, step = 0;
  bool stopped = false;

  bool diverged() const { return result.status == StepStatus::diverged; }
  bool grows(System& system) const {
    return watch.growth_rate > 0 || watch.grows(system.kinetic_energy(end.v), system.potential_energy(end.x));
  }
};

/// How a run ended, in words.
const char* outcome(StepStatus status);

/// `frames` is how many were written.
Json json_of(const Course& course, const SimulateOptions& options, Subject& subject,
             const StepChooser& chooser, int frames);
void print_report(const Course& course, const SimulateOptions& options, Subject& subject,
                  const StepChooser& chooser, int frames);

}  // namespace springstab
