// The lists of the methods built in. A new one is a new file beside this one and one name in `Methods` or
// `MoreMethods`: regions, limits, simulations and the tests that go over all methods then have it, and with
// `Methods` the tables and figures that name none.
#pragma once

#include "solvers/methods/bdf2.h"
#include "solvers/methods/explicit_euler.h"
#include "solvers/methods/generalized_alpha.h"
#include "solvers/methods/hht_alpha.h"
#include "solvers/methods/implicit_damping_euler.h"
#include "solvers/methods/implicit_euler.h"
#include "solvers/methods/linearized.h"
#include "solvers/methods/newmark.h"
#include "solvers/methods/nystrom4.h"
#include "solvers/methods/rk2.h"
#include "solvers/methods/rk4.h"
#include "solvers/methods/rkc2.h"
#include "solvers/methods/sdirk2.h"
#include "solvers/methods/symplectic_euler.h"
#include "solvers/methods/tr_bdf2.h"
#include "solvers/methods/trapezoidal.h"
#include "solvers/methods/velocity_verlet.h"

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

/// Those that are shown where they are asked for, with the parameters they have where none are given.
using MoreMethods = MethodList<VelocityVerlet, Newmark, HhtAlpha, GeneralizedAlpha, Bdf2, Trapezoidal, Sdirk2,
                               TrBdf2, ImplicitDampingEuler, Rkc2, Nystrom4>;

}  // namespace springstab
