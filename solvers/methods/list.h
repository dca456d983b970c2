// The list of the methods built in. A new one is a new file beside this one and one name in `Methods`:
// regions, limits, simulations, figures and the tests that go over all methods then have it.
#pragma once

#include "solvers/methods/explicit_euler.h"
#include "solvers/methods/implicit_euler.h"
#include "solvers/methods/linearized.h"
#include "solvers/methods/rk2.h"
#include "solvers/methods/rk4.h"
#include "solvers/methods/symplectic_euler.h"

namespace springstab {

template <class... Description>
struct MethodList {
  /// Calls visit(description) for every method, in order.
  template <class Visitor>
  static void for_each(Visitor&& visit) {
    (visit(Description()), ...);
  }
};

using Methods = MethodList<ExplicitEuler, Rk2, Rk4, ImplicitEuler, SymplecticEuler, LinearizedExplicitEuler,
                           LinearizedRk4>;

}  // namespace springstab
