// `simulate --error E`: which method and step, and how wrong the run was. The error is the mean over sixteen
// times of how far the positions are off, relative to how far they have moved, weighted by mass:
//     error² = Σ‖x(t) - exact(t)‖² / Σ‖exact(t) - x(0)‖²
// Of a method of order p, e is estimated from a second run at half the step, δ away: e = δ / (1 - 2^-p).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/limits/cheapest_method.h"
#include "experiments/command/interrupt.h"
#include "experiments/command/output.h"
#include "experiments/simulate_options.h"

namespace springstab {

/// Throws InputError where what was typed does not go together.
void check_error_options(const SimulateOptions& options, const CommonOptions& common);

class ErrorRun {
 public:
  /// Chooses the cheapest method and its step, of a subject as it is to run. Both must outlive it.
  ErrorRun(const CommonOptions& common, const SimulateOptions& options, Subject& subject);

  /// Those of the run to make now: with a method, and with the chosen step as the largest one.
  const SimulateOptions& options() const { return options_; }
  /// Why there is no run to make; empty where there is one.
  const std::string& no_choice() const { return no_choice_; }

  /// Sees every good state of the run.
  void see(double time, const State<Vector>& state);
  /// Before that time it has no use for states [s].
  double unseen_until() const;
  /// After a run whose last steps had length h [s]: makes the second one, unless interrupted. Whether the run
  /// is to be made again, which happens once.
  bool is_to_repeat(const State<Vector>& start, double h, const StopOnInterrupt& interrupt);

  bool missed() const { return !(estimate_ && *estimate_ <= *options_.error); }
  Json json() const;
  std::string text_of() const;

 private:
  struct Sample {
    double time;  // [s]
    Vector x;
  };
  std::optional<double> difference(const State<Vector>& start, double h, const StopOnInterrupt& interrupt);

  const CommonOptions& common_;
  SimulateOptions options_;
  Subject& subject_;
  bool designed_;
  std::string no_choice_, reason_;
  std::optional<double> predicted_, estimate_;
  double check_step_ = 0;
  int runs_ = 0;
  std::vector<Sample> samples_;
};

}  // namespace springstab
