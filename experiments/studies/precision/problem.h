// What methods are compared on: a system, its start and a time to simulate.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "analysis/model.h"
#include "analysis/structure_limits.h"
#include "experiments/command/options.h"

namespace springstab {

class Problem {
 public:
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;
  /// Throws InputError where alpha is left to the design.
  Problem(std::string title, Model model, double duration, const CommonOptions& common);

  const std::string& title() const { return title_; }
  double duration() const { return duration_; }  // [s]
  const State<Vector>& start() const { return start_; }
  const EnergyWatch& watch() const { return watch_; }

  const Model& model() const { return model_; }
  System& system() { return model_.system(); }
  Scene* scene() { return model_.scene(); }
  bool is_linear() const { return model_.is_linear(); }
  const DampingModel& damping() const { return damping_; }
  /// Of the start.
  const StructuralMatrices& matrices() const { return limits_->structure().matrices; }
  double k0() { return limits_->k0().value; }                // at the start, by ARPACK [1/s²]
  double set_up_seconds() const { return set_up_seconds_; }  // CPU time of k0

  /// Fits the damping to each method's step from now on. Throws std::invalid_argument where that cannot be.
  void design_damping();
  bool is_designed() const { return designed_; }
  /// The damping that goes with a step: the own one unless it is designed.
  void set_damping_for(std::string_view method, double h);
  void set_own_damping();

  /// Largest stable step of a method for the linear system of the start [s]: ∞ where nothing limits it, 0
  /// where no positive step is stable, nothing where it is not known.
  std::optional<double> limit(std::string_view method);

 private:
  std::string title_;
  Model model_;
  double duration_;
  State<Vector> start_;
  EnergyWatch watch_;
  DampingModel damping_;                   // its own
  std::optional<StructureLimits> limits_;  // of the start, with its own damping
  double set_up_seconds_ = 0;
  bool designed_ = false;
};

}  // namespace springstab
