// Theory against simulation on cloth: at which multiple of the predicted limit do a scene and its linear
// system diverge, and which safety factor on k0 would the scene have needed?
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "experiments/inputs/subject.h"
#include "experiments/runs/journal.h"

namespace springstab {

/// A run at h = ratio · h_limit.
struct ClothRun {
  std::string scene, damping, method;
  bool linear;  // of the system linearized at the start; else of the scene
  double ratio, h;
  long steps;
  bool diverged;
};

/// What a scene's own runs say of one method under one damping.
struct NeededSafety {
  std::string scene, damping, method;
  double d0, alpha;                     // Rayleigh damping [1/s, s]
  double h_limit;                       // of the linear system at the start [s]
  double k0_growth;                     // largest k0(t)/k0(0) along the scene's motion
  std::optional<double> bounded_ratio;  // the largest below which no run diverged, of h_limit
  std::optional<double> factor;         // the least F >= 1 whose recommended step did not diverge
};

struct ClothStudy {
  std::vector<ClothRun> runs;
  std::vector<NeededSafety> needed;
  long linear_disagreements = 0;  // linear runs that diverge below the limit or stay bounded above it
  long outside_band = 0;          // of these, runs long enough to tell
};

struct ClothStudyOptions {
  double duration = 1;  // of the scene's runs [s]
  long linear_steps = 4000;
  std::vector<double> ratios;  // ascending
  std::uint64_t seed = 1;
  std::vector<Method> methods = all_methods();
};

/// Runs the scene under air drag alone, under Rayleigh damping with alpha = 1e-4 s, and under that fitted to
/// each method's step, by every method that has a limit of at least a tenth of 2/√k0 (shorter ones would
/// take too long). Linearized methods freeze the projected stiffness. `report` gets the part done. Each
/// method under one damping is a piece of the journal. The scene's material has no
/// damping (not checked); its Rayleigh damping is set aside.
ClothStudy study_cloth(const std::string& name, Subject& subject, const ClothStudyOptions& options,
                       const std::function<void(double)>& report, Journal& journal = Journal::none());

}  // namespace springstab
