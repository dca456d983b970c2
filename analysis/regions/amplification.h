// Methods on many oscillators at once, X = hd, Y = h²k (paper Eq. 21): cells of the X-Y plane.
#pragma once

#include <span>

#include "analysis/method.h"

namespace springstab {

/// ρ(A) at each (x[i], y[i]), written to rho, ∞ at a pole and where the step overflows; the spans have one
/// length.
void spectral_radius(const Method& method, std::span<const double> x, std::span<const double> y,
                     std::span<double> rho);

/// Really runs `steps` steps of the method on the oscillator of each (x[i], y[i]): diverged once |x| or |v|
/// exceeds `threshold`, decayed if both end below 1/threshold, bounded otherwise.
void simulate_cells(const Method& method, std::span<const double> x, std::span<const double> y, long steps,
                    double threshold, std::span<CellFate> fate);

}  // namespace springstab
