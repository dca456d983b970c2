// Eigenvalues of the damped system M x'' = -K x - D v itself, and the step that a method can take with them.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/method.h"
#include "analysis/spectra/arpack.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Up to as many unknowns the generator [[0, 1], [-K', -D']] is solved densely.
inline constexpr Eigen::Index generator_limit = 400;

/// K', D' and the generator in a time that is dimensionless, its unit 1/rate.
struct Generator {
  double rate = 0;  // √‖K'‖, or ‖D'‖ where K is zero [1/s]
  Eigen::MatrixXd stiffness, damping, matrix;
};

/// Nothing above `generator_limit` unknowns and where both matrices are zero.
std::optional<Generator> dimensionless_generator(const StructuralMatrices& s);

/// All of the generator's eigenvalues [1/s], computed densely; nothing above `generator_limit` unknowns and
/// where that did not converge. Of rounding's size beside the largest, they are refined: then each real part
/// is known to its own scale, and 0 where it is nothing but rounding of its own motion. Rigid motions, whose
/// stiffness is nothing else, are left out.
std::optional<std::vector<std::complex<double>>> generator_spectrum(const StructuralMatrices& s);

/// What an eigenpair (μ, v) sees of the matrices, v*v = 1 in the mass inner product: μ² + dμ + k = 0.
struct DampedMode {
  std::complex<double> mu;  // [1/s]
  double d, k;              // v*D'v [1/s], v*K'v [1/s²]
};

/// The eigenpairs of those eigenvalues.
std::optional<std::vector<DampedMode>> damped_modes(const StructuralMatrices& s);

/// The largest Re μ [1/s] where that is above 0: the motion itself grows, whatever the method; else 0.
double growth_rate(const std::vector<std::complex<double>>& modes);

/// The eigenvalues [1/s] nearest to `shift`, about `count` of them: ARPACK's, of the real part of
/// (C - shift)⁻¹, which has the eigenvectors of the generator C. Each solves μ² M x + μ D x + K x = 0 to 1e-6
/// of its terms; nothing where none does or the shifted matrix is singular.
std::vector<std::complex<double>> modes_near(const StructuralMatrices& s, std::complex<double> shift,
                                             Eigen::Index count, const ArpackOptions& options = {});

/// The largest H such that every 0 < h < H keeps all these modes stable or neutral, but those that grow by
/// themselves. It is for methods with a stability function, and an estimate, since the eigenvalues carry
/// rounding. Nothing for other methods, and where it hinges on a real part that is 0 or, with `largest` the
/// fastest rate of motion [1/s], below 1e-9 of it: rounding.
std::optional<double> critical_step(const Method& method, const std::vector<std::complex<double>>& modes,
                                    double largest = 0);

}  // namespace springstab
