// Runs a case of the catalogue by a method as `simulate` would, and says what came of it.
#pragma once

#include "analysis/spectra/spectrum.h"
#include "experiments/command/options.h"
#include "experiments/studies/stress/catalogue.h"

namespace springstab {

struct StressResult {
  std::string kind, name, method;
  StressOutcome expected = StressOutcome::right, outcome = StressOutcome::wrong;
  std::string detail;           // the message of a refusal, or what is wrong
  double step = 0;              // [s]; 0 where there was none
  long steps = 0;               // that were completed
  std::optional<double> error;  // of the places at the end, of what they moved

  bool as_expected() const { return outcome == expected; }
};

/// The step is the recommended one, but at most a hundredth of the duration, and the watch that of
/// `simulate`. A run that would take too many steps ends early, and what it reached is compared. Errors are
/// mass-weighted, at most a tenth counts as right. `folder` exists. k0 of the
/// case is found by its first method and kept for the others.
StressResult run_stress(const StressCase& c, std::string_view method, const std::string& folder,
                        const CommonOptions& common, std::optional<StiffestMode>& k0);

}  // namespace springstab
