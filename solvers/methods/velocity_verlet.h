// Velocity Verlet with explicit damping, each half kick with the velocity of its own start:
//     w = v + ½h a(x, v),   x⁺ = x + hw,   v⁺ = w + ½h a(x⁺, w).
// Two forces a step, of order 2 where they do not depend on v and 1 where they do. Stable for X = hd < 4 and,
// c = 1 - X/2, Y = h²k < 4(1 + c²)/(1 + c). (The variant that carries a(x⁺, w) into the next step, one force
// a step, is symplectic Euler.)
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/system.h"

namespace springstab {

struct VelocityVerlet {
  MethodInfo info() const { return {"velocity-verlet", "velocity Verlet", 1, false}; }
  template <class V>
  class Steps;
};

template <class V>
class VelocityVerlet::Steps {
 public:
  template <Accelerating<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    system.acceleration(state.x, state.v, a_);
    v_ = state.v + (0.5 * h) * a_;
    x_ = state.x + h * v_;
    system.acceleration(x_, v_, a_);
    v_ = v_ + (0.5 * h) * a_;
    return commit(state, x_, v_);
  }

 private:
  V x_, v_, a_;
};

}  // namespace springstab
