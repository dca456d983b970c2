// Eigen's dense solvers, compiled once, in dense_solvers.cpp: each costs every unit that compiles it anew
// seconds. Include this in place of <Eigen/Eigenvalues> and <Eigen/Cholesky>, and hand the solvers a
// MatrixXd, not an expression, which is another template.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace Eigen {

extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
extern template GeneralizedSelfAdjointEigenSolver<MatrixXd>&
GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(const MatrixXd&, const MatrixXd&, int);
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

}  // namespace Eigen
