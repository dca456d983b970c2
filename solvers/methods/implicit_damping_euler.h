// Symplectic Euler, kick then drift, with the damping taken implicitly, as physics engines do:
//     (1 + hD') (v⁺ - v) = h a(x, v),   x⁺ = x + hv⁺.
// Stable exactly for Y < 4 + 2X; for matrices while λ_max(h²K' - 2hD') < 4.
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/methods/parameters.h"
#include "solvers/system.h"

namespace springstab {

struct ImplicitDampingEuler {
  std::string name = "implicit-damping-euler";

  ImplicitDampingEuler() = default;
  explicit ImplicitDampingEuler(Parameters& given) : name(given.text()) {
    given.require(given.word("part", "all") == "all", "part=all");
  }
  MethodInfo info() const { return {name, "Euler, implicit damping", 1, true}; }
  template <class V>
  class Steps;
};

template <class V>
class ImplicitDampingEuler::Steps {
 public:
  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    system.acceleration(state.x, state.v, a_);
    a_ = h * a_;
    system.linearize(state.x, state.v, linear_);
    const SolveReport solved = linear_->solve_shifted({1, h, 0}, a_, v_);
    if (solved.status != StepStatus::done) return solved.status;
    v_ = state.v + v_;
    x_ = state.x + h * v_;
    return commit(state, x_, v_);
  }

 private:
  Linearization<V> linear_ = {};
  V x_, v_, a_;
};

}  // namespace springstab
