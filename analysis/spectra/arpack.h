// ARPACK behind one door: the largest eigenvalues of a symmetric operator, and the eigenvalues of largest
// modulus of a general one. An operator is a size and a product; no matrix is needed.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace springstab {

/// out = A in, both of length `size`. The product must not start another eigenvalue solve.
struct LinearOperator {
  Eigen::Index size = 0;
  std::function<void(const Eigen::VectorXd& in, Eigen::VectorXd& out)> apply;
  // Of a symmetric one: bounds on its eigenvalues, where they are known.
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

struct ArpackOptions {
  double tolerance = 1e-10;      // on ‖Av - θv‖, relative to |θ|
  Eigen::Index basis_size = 32;  // Lanczos/Arnoldi vectors kept (ncv)
  int max_restarts = 2000;
  std::uint64_t seed = 1;   // of the start vector
  Eigen::VectorXd start{};  // used instead if not empty, as from a nearby operator's eigenvector
  std::function<void()> before_product{};  // may throw to give up
};

/// `start`, or where that is empty entries uniform in (-1, 1) from the seed. Throws std::invalid_argument for
/// size 0 and for a start of another size, not finite or zero.
Eigen::VectorXd start_vector(Eigen::Index size, const Eigen::VectorXd& start, std::uint64_t seed);

/// What a symmetric solve found. `values` holds the converged eigenvalues only, largest first; it is empty,
/// never garbage, when nothing converged.
struct SymmetricEigenpairs {
  bool converged = false;  // all that were wanted
  std::vector<double> values;
  Eigen::MatrixXd vectors;        // one column per value, of unit norm
  std::vector<double> residuals;  // ‖Av - θv‖, computed after the fact
  long products = 0;
};

struct Eigenvalues {
  bool converged = false;
  std::vector<std::complex<double>> values;  // largest modulus first
  Eigen::MatrixXcd vectors;                  // one column per value, of unit norm
  long products = 0;
};

/// The `count` algebraically largest eigenvalues; a multiple one may be found fewer times than it is there,
/// and smaller ones then follow. The eigenvalue 0 may be missed, as ARPACK multiplies its start vector by the
/// operator: shift an operator whose largest may be 0. Needs count < size; solve smaller problems densely.
/// Throws std::invalid_argument for impossible sizes or a non-finite product, std::logic_error when called
/// from within a product, std::runtime_error for any other failure that ARPACK reports. One solve runs at a
/// time: ARPACK keeps its state in static variables.
SymmetricEigenpairs largest_eigenpairs(const LinearOperator& a, Eigen::Index count,
                                       const ArpackOptions& options = {});

/// The `count` eigenvalues of largest modulus of a general operator. Needs count < size - 1. Throws likewise.
/// Do not expect convergence for a stable transition matrix: its largest eigenvalues cluster near 1.
Eigenvalues dominant_eigenvalues(const LinearOperator& a, Eigen::Index count,
                                 const ArpackOptions& options = {});

}  // namespace springstab
