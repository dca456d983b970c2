// How several steps of a method go through a linear system together: what a method does between two
// accelerations, it does for each unknown by itself, so a few rows of a stage can be evaluated as soon as the
// rows that couple to them have gone through the stage before (LinearSystem::take_steps).
#pragma once

#include "solvers/system.h"
#include "solvers/team.h"

namespace springstab {

/// A step of an explicit method, stage by stage, on some unknowns at a time.
class StepByRows {
 public:
  virtual ~StepByRows() = default;
  /// Accelerations in a step, at least 1.
  virtual int stages() const = 0;
  /// Where stage 0 <= i < stages() is evaluated; the first one at the state.
  virtual const Vector& x(int stage) const = 0;
  virtual const Vector& v(int stage) const = 0;
  /// Where its acceleration goes.
  virtual Vector& acceleration(int stage) = 0;
  /// The acceleration of the stage is there in these unknowns: makes the place of the next stage there, or
  /// after the last one the new state, in the memory of the old. Threads may do it for others meanwhile.
  virtual void advance(int stage, const IndexRange& unknowns) = 0;
  /// All unknowns have advanced by a step, to this kinetic energy [J]. Whether the steps are worth having.
  virtual bool accept(double kinetic_energy) = 0;
};

/// That part of any vector.
inline auto entries(const IndexRange& unknowns) {
  return [unknowns](auto& u) { return u.segment(unknowns.first, unknowns.last - unknowns.first); };
}

}  // namespace springstab
