// The acceleration f = a(X, V) of a stage that depends on it, X = x + qf, V = v + gf, as the stages of
// diagonally implicit tableaus and the end of an implicit multistep step are: Newton's steps with one
// linearization, which is that of the first such stage,
//     (1 + gD' + qK') Δ = a(x + qf, v + gf) - f,   f ← f + Δ.
// On a linear system one step from f = 0 is exact.
#pragma once

#include "solvers/system.h"

namespace springstab {

template <class V>
class NewtonStage {
 public:
  /// The next solve linearizes anew.
  void begin() { linearized_ = false; }

  /// f is the start on entry; x, v are the base on entry and X, V where done.
  template <Linearizable<V> System>
  StepStatus solve(System& system, double g, double q, int passes, V& x, V& v, V& f) {
    if constexpr (Linear<System, V>) {
      system.acceleration(x, v, rest_);
      system.linearize(x, v, linear_);
      const SolveReport solved = linear_->solve_shifted({1, g, q}, rest_, f);
      if (solved.status != StepStatus::done) return solved.status;
    } else {
      for (int pass = 0; pass < passes; ++pass) {
        x_ = x + q * f;
        v_ = v + g * f;
        system.acceleration(x_, v_, rest_);
        if (!linearized_) system.linearize(x_, v_, linear_);
        linearized_ = true;
        rest_ = rest_ - f;
        const SolveReport solved = linear_->solve_shifted({1, g, q}, rest_, change_);
        if (solved.status != StepStatus::done) return solved.status;
        f = f + change_;
      }
    }
    x = x + q * f;
    v = v + g * f;
    return StepStatus::done;
  }

 private:
  Linearization<V> linear_ = {};
  bool linearized_ = false;
  V x_, v_, rest_, change_;
};

}  // namespace springstab
