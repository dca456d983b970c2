// Newton's method within an implicit step, beyond the one step of it that each of these methods takes by
// itself. A step solves F(u) = 0 for a velocity or an acceleration u; with K' and D' of the last iterate in
// its derivative J,
//     J δ = -F(u),   u ← u + δ,
// until as many steps are done as are asked for, or a correction is at most `tolerance` of what it corrects.
#pragma once

#include <type_traits>

#include "solvers/system.h"

namespace springstab {

struct NewtonOptions {
  int steps = 1;             // at most, the method's own first one included
  double tolerance = 1e-10;  // ‖δ‖/‖u‖ that is enough
};

template <class V>
class NewtonIteration {
 public:
  /// True: who has such an iteration has a use for them.
  bool set(const NewtonOptions& options) {
    options_ = options;
    return true;
  }

  /// The steps after the first. `linearize(r)` sets r = -F(u) and linearizes at u; solve(r, δ) solves with J;
  /// `correct(δ)` adds δ to u, which it returns. One oscillator is linear: nothing is left to improve.
  template <class Linearize, class Solve, class Correct>
  StepStatus improve(const Linearize& linearize, const Solve& solve, const Correct& correct) {
    if constexpr (std::is_same_v<V, Vector>)
      for (int i = 1; i < options_.steps; ++i) {
        linearize(right_);
        if (const SolveReport solved = solve(right_, change_); solved.status != StepStatus::done)
          return solved.status;
        const V& u = correct(change_);
        if (!(change_.norm() > options_.tolerance * u.norm())) break;
      }
    return StepStatus::done;
  }

 private:
  NewtonOptions options_;
  V right_, change_;
};

}  // namespace springstab
