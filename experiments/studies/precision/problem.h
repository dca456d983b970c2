// What methods are compared on: a system, its start and a time to simulate.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "analysis/limits/general_damping.h"
#include "experiments/command/options.h"
#include "experiments/inputs/subject.h"
#include "solvers/spring_chain.h"

namespace springstab {

class Problem {
 public:
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;
  Problem(std::string title, Subject subject, double duration, const CommonOptions& common);
  /// Starts at rest, displaced by x [m].
  Problem(std::string title, SpringChain chain, const Vector& x, double duration,
          const CommonOptions& common);

  const std::string& title() const { return title_; }
  double duration() const { return duration_; }  // [s]
  const State<Vector>& start() const { return start_; }
  const EnergyWatch& watch() const { return watch_; }

  System& system();
  Scene* scene() { return subject_ ? subject_->scene() : nullptr; }
  bool is_linear() { return !scene(); }
  const DampingModel& damping() const { return damping_; }
  /// M, K and D of the start.
  const StructuralMatrices& structure() const { return structure_; }
  double k0() const { return k0_.value; }                    // at the start, by ARPACK [1/s²]
  double set_up_seconds() const { return set_up_seconds_; }  // CPU time of k0

  /// Fits the damping to each method's step from now on. Throws InputError where that cannot be.
  void design_damping();
  bool is_designed() const { return designed_; }
  /// The damping that goes with a step: the own one unless it is designed.
  void set_damping_for(std::string_view method, double h);
  void set_own_damping();

  /// Largest stable step of a method for the linear system of the start [s]: ∞ where nothing limits it, 0
  /// where no positive step is stable, nothing where it is not known.
  std::optional<double> limit(std::string_view method);

 private:
  void prepare(const CommonOptions& common);
  void set_alpha(double alpha);

  std::string title_;
  std::optional<Subject> subject_;
  std::unique_ptr<SpringChain> chain_;
  double duration_;
  State<Vector> start_;
  EnergyWatch watch_;
  StructuralMatrices structure_;
  DampingModel damping_;
  StiffestMode k0_;
  std::unique_ptr<GeneralDamping> general_damping_;  // made when asked for; refers to the two above
  double set_up_seconds_ = 0;
  bool designed_ = false;
  std::uint64_t seed_ = 1;
};

}  // namespace springstab
