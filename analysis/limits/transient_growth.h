// What a stable method lets happen before it decays: A is not normal, and its powers may grow first, without
// bound towards double eigenvalues of modulus 1.
//
//     const double growth = transient_growth("explicit-euler", 3.9, 3.9);
//     std::cout << "a stable run may grow " << growth << "-fold before it decays\n";
#pragma once

#include "analysis/limits/step_limits.h"
#include "analysis/method.h"

namespace springstab {

/// The largest ‖Aⁿ‖ over 0 <= n <= steps of an oscillator at (X, Y), Y > 0, in the norm of its energy,
/// √(½ m v² + ½ m k x²): a lower bound of the supremum over all n. ∞ where a power overflows.
/// Of a method that carries more than x and v, those after the start of a run with any x and v.
double transient_growth(const Method& method, double x, double y, long steps = 2000);

/// The same of the system of these modes at the step h [s], over a sample of them, k_max included. In the
/// norm of the energy ‖Aⁿ‖ of the whole system is the largest of its modes', so this too is a lower bound.
double transient_growth(const Method& method, const RayleighModes& modes, double h);

}  // namespace springstab
