// The trapezoidal rule, u⁺ = u + ½h(u' + u'⁺): of order 2 and stable at every step, and without damping of
// its own. Newmark's average acceleration with the forces of the state at the beginning of each step.
#pragma once

#include "solvers/methods/diagonally_implicit.h"

namespace springstab {

struct Trapezoidal {
  static constexpr DiagonallyImplicitTableau<2> tableau{{{{0}, {0.5, 0.5}}}};

  MethodInfo info() const { return {"trapezoidal", "trapezoidal rule", 2, true}; }
  template <class V>
  using Steps = DiagonallyImplicit<V, tableau>;
};

}  // namespace springstab
