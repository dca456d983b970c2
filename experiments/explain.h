// What `simulate --explain` tells: which parts a scene has, what each costs a step, and what was left out.
#pragma once

#include <string>
#include <string_view>

#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "solvers/simulation.h"

namespace springstab {

/// Measures the parts of the subject's scene at `start`, and counts what a step of the method takes there:
/// "parts" (name, elements, bytes where something is stored, work, seconds each time, times a step),
/// "steps_tried", "left_out". The state of the scene is not changed.
Json explain(Subject& subject, std::string_view method, const StepPlan& plan, const State<Vector>& start);

/// The same for people.
std::string explanation_table(const Json& explanation);

}  // namespace springstab
