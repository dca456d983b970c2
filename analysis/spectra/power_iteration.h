// The power method (paper §5.3): the eigenvalue of largest modulus of a symmetric operator by repeated
// products alone. For a stiffness that is that of the stiffest mode, k0, unless compression is stronger than
// any stretch.
#pragma once

#include "analysis/spectra/arpack.h"

namespace springstab {

struct PowerIterationOptions {
  double tolerance = 1e-2;  // on ‖Av - θv‖, relative to |θ|
  long max_products = 1'000'000;
  std::uint64_t seed = 1;   // of the start vector
  Eigen::VectorXd start{};  // used instead if not empty: of the operator's size, not zero
};

/// The Rayleigh quotient θ = vᵀAv of the unit vector v that the iteration ended with. Some eigenvalue is
/// within `residual` of it; without `converged` it is whatever the products led to.
struct PowerIteration {
  bool converged = false;
  double value = 0;
  double residual = 0;  // ‖Av - θv‖
  Eigen::VectorXd vector;
  long products = 0;
};

/// Throws std::invalid_argument for an empty operator, an unusable start or a non-finite product.
PowerIteration power_iteration(const LinearOperator& a, const PowerIterationOptions& options = {});

}  // namespace springstab
