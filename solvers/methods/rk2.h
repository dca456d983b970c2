// The midpoint method (Runge-Kutta of order 2), paper Eq. 18.
#pragma once

#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/methods/method_info.h"

namespace springstab {

inline constexpr ExplicitTableau<2> midpoint_tableau{.a = {{{}, {0.5}}}, .b = {0, 1}};

struct Rk2 {
  MethodInfo info() const { return {"rk2", "midpoint (RK2)", 2, false}; }
  template <class V>
  using Steps = ExplicitRungeKutta<V, midpoint_tableau>;
};

}  // namespace springstab
