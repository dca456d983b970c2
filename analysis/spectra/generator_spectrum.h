// Eigenvalues of the damped system M x'' = -K x - D v itself, and the step that a method can take with them.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/spectra/arpack.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Up to as many unknowns the generator [[0, 1], [-K', -D']] is solved densely.
inline constexpr Eigen::Index generator_limit = 400;

/// All of the generator's eigenvalues [1/s], computed densely; nothing above `generator_limit` unknowns and
/// where that did not converge. Those below 1e-6 of √‖K'‖, or of ‖D'‖ where K is zero, are left out: rigid
/// motions, but for rounding.
std::optional<std::vector<std::complex<double>>> generator_spectrum(const StructuralMatrices& s);

/// What an eigenpair (μ, v) sees of the matrices, v*v = 1 in the mass inner product: μ² + dμ + k = 0.
struct DampedMode {
  std::complex<double> mu;  // [1/s]
  double d, k;              // v*D'v [1/s], v*K'v [1/s²]
};

/// The eigenpairs of those eigenvalues.
std::optional<std::vector<DampedMode>> damped_modes(const StructuralMatrices& s);

/// The largest Re μ [1/s] where that is more than rounding: the motion itself grows, whatever the method;
/// else 0.
double growth_rate(const std::vector<std::complex<double>>& modes);

/// The eigenvalues [1/s] nearest to `shift`, about `count` of them: ARPACK's, of the real part of
/// (C - shift)⁻¹, which has the eigenvectors of the generator C. Each solves μ² M x + μ D x + K x = 0 to 1e-6
/// of its terms; nothing where none does or the shifted matrix is singular.
std::vector<std::complex<double>> modes_near(const StructuralMatrices& s, std::complex<double> shift,
                                             Eigen::Index count, const ArpackOptions& options = {});

/// The largest H such that every 0 < h < H keeps all these modes stable or neutral, but those that grow by
/// themselves. It is for methods with a stability function, whose eigenvalues on the modes are R(hμ), and an
/// estimate, since the eigenvalues carry rounding. Nothing for other methods, and where it hinges on a real
/// part of rounding's size: 1e-9 of the largest |μ| of these modes or, where they are only some, of
/// `largest`.
std::optional<double> critical_step(const Method& method, const std::vector<std::complex<double>>& modes,
                                    double largest = 0);

}  // namespace springstab
