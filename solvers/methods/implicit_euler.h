// Implicit (backward) Euler with one Newton step, paper Eq. 16 and the course notes' Eqs. 16/19, written for
// the velocity's change: with K and D of the state,
//     (1 + hD' + h²K') (v⁺ - v) = h (a(x, v) - hK'v),   x⁺ = x + hv⁺.
// Further Newton steps solve v⁺ = v + ha(x⁺, v⁺).
// (Multiply out and the notes' (M + hD + h²K) v⁺ = Mv + hf + hDv follows; their D and K have the other sign.)
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
#include "solvers/system.h"

namespace springstab {

struct ImplicitEuler {
  MethodInfo info() const { return {"implicit-euler", "implicit Euler", 1, true}; }
  template <class V>
  class Steps;
};

template <class V>
class ImplicitEuler::Steps {
 public:
  bool set_newton(const NewtonOptions& options) { return newton_.set(options); }

  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    system.acceleration(state.x, state.v, a_);
    system.linearize(state.x, state.v, linear_);
    linear_->stiffness_times(state.v, v_);
    a_ = h * (a_ - h * v_);
    const SolveReport solved = linear_->solve_shifted({1, h, h * h}, a_, v_);
    if (solved.status != StepStatus::done) return solved.status;
    v_ = state.v + v_;
    x_ = state.x + h * v_;
    const StepStatus status = newton_.improve(
        [&](V& right) {
          system.acceleration(x_, v_, a_);
          system.linearize(x_, v_, linear_);
          right = state.v + h * a_ - v_;
        },
        [&](const V& right, V& change) {
          return linear_->solve_shifted({1, h, h * h}, right, change);
        },
        [&](const V& change) -> const V& {
          x_ = x_ + h * change;
          return v_ = v_ + change;
        });
    if (status != StepStatus::done) return status;
    return commit(state, x_, v_);
  }

 private:
  Linearization<V> linear_ = {};
  NewtonIteration<V> newton_;
  V x_, v_, a_;
};

}  // namespace springstab
