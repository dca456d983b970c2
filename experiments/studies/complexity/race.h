// Methods against each other on draping cloths (paper §5): each takes the step that its rule gives it, rounds
// are interleaved so that no method has the machine to itself, and what the clock says stands beside counts
// that no clock changes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/spectra/spectrum.h"
#include "experiments/command/options.h"
#include "experiments/runs/journal.h"
#include "experiments/runs/measured_run.h"
#include "experiments/studies/complexity/drape.h"
#include "solvers/linear/conjugate_gradient.h"

namespace springstab {

/// Which D a contestant has, beside the drape's d0.
enum class DampingRule {
  designed,  // alpha fitted to its own step (paper §3.2)
  drag,      // alpha = 0, all that implicit Euler needs (paper §3.4)
  leu,       // the alpha of linearized explicit Euler on the same drape
};

struct Racer {
  std::string name, method;
  DampingRule damping = DampingRule::designed;
  Preconditioner preconditioner = Preconditioner::block_ssor;  // of implicit Euler
  double cg_tolerance = 1e-3;
};

/// k0 of a drape at its start, before any run. Throws std::runtime_error if ARPACK does not converge.
StiffestMode k0_of(const Drape& drape, const CommonOptions& common);

/// One contestant on one drape. `interval` is the step of an implicit method and the time between
/// linearizations of a linearized one [s]; explicit steps follow from k0 with the safety factor 1.5.
struct Heat {
  Racer contestant;
  Drape drape;
  StiffestMode k0;        // of the drape
  double duration = 0.5;  // [s]
  double interval = 0.01;
};

struct HeatResult {
  Heat heat;
  double h = 0, alpha = 0;  // of the last plan [s]
  long steps = 0;
  Counts counts;
  long rollbacks = 0, halved_steps = 0;
  bool finished = false;            // came to its end, at a finite state
  std::vector<double> cpu_seconds;  // one per round

  double median_seconds() const;
};

/// Every heat once a round, after a short warm-up of each. Linearizations use the projected Hessian. Throws
/// std::logic_error should a contestant's counts differ between rounds. `update` gets the fraction done. Each
/// run is a piece of the journal.
std::vector<HeatResult> race(const std::vector<Heat>& heats, int rounds, const CommonOptions& common,
                             const std::function<void(double)>& update = {},
                             Journal& journal = Journal::none());

}  // namespace springstab
