// Nyström's method of order 4 for x'' = a(x, v) (1925), four forces a step:
//     a₁ = a(x, v),   a₂ = a(x + ½hv + ⅛h²a₁, v + ½ha₁),   a₃ = a(the same x, v + ½ha₂),
//     a₄ = a(x + hv + ½h²a₃, v + ha₃),
//     x⁺ = x + hv + h²(a₁ + a₂ + a₃)/6,   v⁺ = v + h(a₁ + 2a₂ + 2a₃ + a₄)/6.
// Its eigenvalues are no function of the motion's own: other than a Runge-Kutta method.
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/system.h"

namespace springstab {

struct Nystrom4 {
  MethodInfo info() const { return {"nystrom4", "Nyström 4", 4, false}; }
  template <class V>
  class Steps;
};

template <class V>
class Nystrom4::Steps {
 public:
  template <Accelerating<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    const V &x = state.x, &v = state.v;
    system.acceleration(x, v, a1_);
    x_ = x + (0.5 * h) * v + (0.125 * h * h) * a1_;
    v_ = v + (0.5 * h) * a1_;
    system.acceleration(x_, v_, a2_);
    v_ = v + (0.5 * h) * a2_;
    system.acceleration(x_, v_, a3_);
    x_ = x + h * v + (0.5 * h * h) * a3_;
    v_ = v + h * a3_;
    system.acceleration(x_, v_, a4_);
    x_ = x + h * v + (h * h / 6) * (a1_ + a2_ + a3_);
    v_ = v + (h / 6) * (a1_ + 2.0 * a2_ + 2.0 * a3_ + a4_);
    return commit(state, x_, v_);
  }

 private:
  V x_, v_, a1_, a2_, a3_, a4_;
};

}  // namespace springstab
