// The amplification matrix A(X, Y) of a method: one step on one oscillator, X = hd, Y = h²k (paper Eq. 21).
// Its columns are the method's own steps from (x, v) = (1, 0) and (0, 1) with h = 1. In numbers it comes
// for eight oscillators at a time, as a formula once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string_view>

#include "analysis/regions/polynomial.h"

namespace springstab {

/// A as rational functions of X and Y, row by row.
using SymbolicAmplification = std::array<RationalFunction, 4>;
SymbolicAmplification symbolic_amplification(std::string_view method);

/// A at one point; rows and columns are (x, v). All ∞ at a pole and where the step overflows.
Eigen::Matrix2d amplification_matrix(std::string_view method, double x, double y);

/// ρ(A) at each (x[i], y[i]), written to rho, ∞ at a pole and where the step overflows; the spans have one
/// length.
void spectral_radius(std::string_view method, std::span<const double> x, std::span<const double> y,
                     std::span<double> rho);

/// Outcome of simulating one oscillator from (x, v) = (1, 0.7).
enum class CellFate : char { decayed, bounded, diverged };

/// Really runs `steps` steps of the method on the oscillator of each (x[i], y[i]): diverged once |x| or |v|
/// exceeds `threshold`, decayed if both end below 1/threshold, bounded otherwise.
void simulate_cells(std::string_view method, std::span<const double> x, std::span<const double> y, long steps,
                    double threshold, std::span<CellFate> fate);

}  // namespace springstab
