// What the parts of the catalogue share. For its own files only.
#pragma once

#include "experiments/studies/stress/catalogue.h"

namespace springstab {

/// Cases of matrices, and of scenes and meshes.
std::vector<StressCase> matrix_cases();
std::vector<StressCase> scene_cases();

void write_text(const std::string& path, const std::string& contents);

// Without damping these methods have no stable step.
inline const Expectation undamped{StressOutcome::right,
                                  {{"explicit-euler", StressOutcome::no_step},
                                   {"rk2", StressOutcome::no_step},
                                   {"linearized-explicit-euler", StressOutcome::no_step}}};
inline const Expectation damped{StressOutcome::right};
inline const Expectation impossible{StressOutcome::refused};

}  // namespace springstab
