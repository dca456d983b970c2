// The list of all methods. A new method is a new file beside this one and one name in `Methods`:
// regions, limits, simulations, figures and the tests that go over all methods then have it.
#pragma once

#include "solvers/methods/explicit_euler.h"
#include "solvers/methods/implicit_euler.h"
#include "solvers/methods/linearized.h"
#include "solvers/methods/rk2.h"
#include "solvers/methods/rk4.h"
#include "solvers/methods/symplectic_euler.h"

namespace springstab {

template <template <class> class... Method>
struct MethodList {
  /// Calls visit.template operator()<Method>() for every method, in order.
  template <class Visitor>
  static void for_each(Visitor&& visit) {
    (visit.template operator()<Method>(), ...);
  }
};

using Methods = MethodList<ExplicitEuler, Rk2, Rk4, ImplicitEuler, SymplecticEuler, LinearizedExplicitEuler,
                           LinearizedRk4>;

}  // namespace springstab
