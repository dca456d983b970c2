// Symplectic Euler, drift then kick: x⁺ = x + hv, v⁺ = v + ha(x⁺, v).
// One force a step, and the same steps as explicit Euler with hK more damping (see explicit_euler.h).
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/system.h"

namespace springstab {

struct SymplecticEuler {
  MethodInfo info() const { return {"symplectic-euler", "symplectic Euler", 1, false}; }
  template <class V>
  class Steps;
};

template <class V>
class SymplecticEuler::Steps {
 public:
  template <Accelerating<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    x_ = state.x + h * state.v;
    system.acceleration(x_, state.v, a_);
    v_ = state.v + h * a_;
    return commit(state, x_, v_);
  }

 private:
  V x_, v_, a_;
};

}  // namespace springstab
