// The state transition matrix of a method on a linear system, as an operator: one step of the method's own
// code per product (paper Eqs. 12, 15-19; w = (x, v), no constant force).
#pragma once

#include <memory>
#include <string_view>

#include "analysis/spectra/arpack.h"
#include "solvers/system.h"

namespace springstab {

/// Size 2n: (x, v) -> the state one step h later. `system` must outlive it. A product throws
/// std::runtime_error when the step fails; an iterative linear solve inside should be set to 1e-13.
LinearOperator transition_operator(LinearSystem& system, std::string_view method, double h);

}  // namespace springstab
