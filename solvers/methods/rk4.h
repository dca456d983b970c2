// The classical Runge-Kutta method of order 4, paper Eq. 19.
#pragma once

#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/methods/method_info.h"

namespace springstab {

inline constexpr ExplicitTableau<4> rk4_tableau{
    .a = {{{}, {0.5}, {0, 0.5}, {0, 0, 1}}},
    .b = {1. / 6, 1. / 3, 1. / 3, 1. / 6},
};

struct Rk4 {
  MethodInfo info() const { return {"rk4", "Runge-Kutta 4", 4, false}; }
  template <class V>
  using Steps = ExplicitRungeKutta<V, rk4_tableau>;
};

}  // namespace springstab
