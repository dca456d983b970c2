// An eigenvalue of a damped system to its own scale, however fast other motions are: Rayleigh quotients with
// residuals in twice the precision, on the matrices as they were given.
//     P(μ) x = (μ² M + μ D + K) x = 0,   yᵀ P(μ) = 0,   μ ← μ - yᵀ P(μ) x / yᵀ P'(μ) x
#pragma once

#include <complex>

#include "solvers/linear/structural_matrices.h"

namespace springstab {

struct RefinedEigenvalue {
  std::complex<double> value;  // its real part 0 where that is rounding's, or did not settle [1/s]
  bool rigid = false;          // nothing but rounding resists it
};

class EigenvalueRefinement {
 public:
  /// `rate` [1/s] makes time dimensionless.
  EigenvalueRefinement(const StructuralMatrices& s, double rate);

  /// The eigenvalue near mu [1/s]. Its real part counts as known where it is more than what rounding the
  /// entries of the matrices (of D alone where all are symmetric) may make of it: n u |y|ᵀ|P||x| / |yᵀP'x|.
  RefinedEigenvalue refine(std::complex<double> mu) const;

 private:
  bool is_rigid(const Eigen::VectorXcd& x, const Eigen::VectorXcd& y) const;

  double rate_;
  bool symmetric_;
  Eigen::MatrixXd mass_, damping_, stiffness_;  // scaled by powers of two, so exactly
};

}  // namespace springstab
