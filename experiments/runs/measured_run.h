// One run of a system by a method, with what it cost: CPU seconds, and counts that no clock changes.
#pragma once

#include <string>
#include <string_view>

#include "experiments/command/output.h"
#include "solvers/counting.h"
#include "solvers/cpu_time.h"
#include "solvers/simulation.h"

namespace springstab {

/// The counts by their names.
Json json_of(const Counts& counts);
Counts counts_of(const Json& json);

/// Where and how times were taken, for the foot of a figure: processor, compiler, flags, commit.
std::string provenance();

struct MeasuredRun {
  SimulationResult result;
  Counts counts;
  double cpu_seconds = 0;  // of the steps, the observer and the policy
  State<Vector> end;       // where it ended
};

/// Carries out the plan from `start`, as simulate() does.
MeasuredRun measured_run(System& system, std::string_view method, const StepPlan& plan,
                         const EnergyWatch& watch, const State<Vector>& start, const Observer& observe = {},
                         const StepPolicy& policy = {}, StepFilter* filter = nullptr,
                         const UnseenUntil& unseen_until = {});

}  // namespace springstab
