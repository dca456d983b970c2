// The state transition matrix of a method on a linear system, as an operator: one step of the method's own
// code per product (paper Eqs. 12, 15-19; w = (x, v, what the method carries), no constant force).
#pragma once

#include "analysis/method.h"
#include "analysis/spectra/arpack.h"
#include "solvers/system.h"

namespace springstab {

/// Size mn, m = 2 + the vectors that the method carries: a state -> the state one step h later, from unit
/// states of any of them, never through the method's start. `system` must outlive it. A product throws
/// std::runtime_error when the step fails; an iterative linear solve inside should be set to 1e-13.
LinearOperator transition_operator(LinearSystem& system, const Method& method, double h);

}  // namespace springstab
