// The coupled stages of a fully implicit Runge-Kutta method, all at once:
//     M out_i + Σ_j (damping_ij D + stiffness_ij K) out_j = M rhs_i,
// sn unknowns by sparse LU factors, which are kept as long as the owner says that the matrices are the same.
#pragma once

#include <Eigen/SparseLU>
#include <vector>

#include "solvers/linear/structural_matrices.h"
#include "solvers/system.h"

namespace springstab {

class CoupledStages {
 public:
  bool is_factorized(const StageCoupling& coupling) const;
  void factorize(const StageCoupling& coupling, const StructuralMatrices& matrices);
  /// Not positive definite where the factorization found the matrix singular.
  SolveReport solve(const SparseMatrix& mass, const std::vector<Vector>& rhs, std::vector<Vector>& out);

 private:
  Eigen::SparseLU<SparseMatrix> factors_;
  StageCoupling coupling_;
  bool singular_ = false;
  Vector right_, all_;
};

}  // namespace springstab
