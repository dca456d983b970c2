// TR-BDF2 (Bank et al. 1985; as a Runge-Kutta method Hosea and Shampine 1996): the trapezoidal rule to
// (2 - √2)h, then the backward differentiation formula of order 2 over both parts. L-stable, of order 2.
#pragma once

#include <numbers>

#include "solvers/methods/diagonally_implicit.h"

namespace springstab {

struct TrBdf2 {
  static constexpr double d = 1 - 1 / std::numbers::sqrt2, w = 1 / (2 * std::numbers::sqrt2);
  static constexpr DiagonallyImplicitTableau<3> tableau{{{{0}, {d, d}, {w, w, d}}}};

  MethodInfo info() const { return {"tr-bdf2", "TR-BDF2", 2, true}; }
  template <class V>
  using Steps = DiagonallyImplicit<V, tableau>;
};

}  // namespace springstab
