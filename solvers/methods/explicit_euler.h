// Explicit (forward) Euler, paper Eqs. 10-11: x⁺ = x + hv, v⁺ = v + ha(x, v).
// With stiffness-proportional damping α = h it takes the very steps of symplectic Euler without it
// (v⁺ = v - hK'x - h·hK'v = v - hK'x⁺), so that damping damps nothing: choose symplectic Euler instead.
#pragma once

#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/methods/method_info.h"

namespace springstab {

struct ExplicitEuler {
  MethodInfo info() const { return {"explicit-euler", "explicit Euler", 1, false}; }
  template <class V>
  using Steps = ExplicitRungeKutta<V, ExplicitTableau<1>{.b = {1}}>;
};

}  // namespace springstab
