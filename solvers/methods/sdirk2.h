// The L-stable diagonally implicit Runge-Kutta method of order 2 with two stages (Alexander 1977),
// γ = 1 - √½.
#pragma once

#include <numbers>

#include "solvers/methods/diagonally_implicit.h"

namespace springstab {

struct Sdirk2 {
  static constexpr double gamma = 1 - 1 / std::numbers::sqrt2;
  static constexpr DiagonallyImplicitTableau<2> tableau{{{{gamma}, {1 - gamma, gamma}}}};

  MethodInfo info() const { return {"sdirk2", "SDIRK2", 2, true}; }
  template <class V>
  using Steps = DiagonallyImplicit<V, tableau>;
};

}  // namespace springstab
