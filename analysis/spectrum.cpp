#include "analysis/spectrum.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace springstab {
namespace {

using Cholesky = Eigen::SimplicialLLT<SparseMatrix>;

constexpr Eigen::Index dense_limit = 150;
constexpr Eigen::Index factorization_limit = 150'000;
constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

// 1/√M_ii: makes the pencil dimensionless per unknown, whatever the ratio of the masses.
Eigen::VectorXd inverse_root_mass(const StructuralMatrices& s) {
  return s.mass.diagonal().cwiseSqrt().cwiseInverse();
}

SparseMatrix scaled(const SparseMatrix& a, const Eigen::VectorXd& d) {
  SparseMatrix b = d.asDiagonal() * a;
  return b * d.asDiagonal();
}

double largest_row_sum(const SparseMatrix& a) {
  return (a.cwiseAbs() * Eigen::VectorXd::Ones(a.cols())).maxCoeff();
}

StiffestMode dense_spectrum(const LinearOperator& s) {
  Eigen::MatrixXd matrix(s.size, s.size);
  Eigen::VectorXd column;
  for (Eigen::Index j = 0; j < s.size; ++j) {
    s.apply(Eigen::VectorXd::Unit(s.size, j), column);
    matrix.col(j) = column;
  }
  if (!matrix.allFinite())
    throw std::invalid_argument("the mass-scaled stiffness is not finite, expected finite matrices");
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (matrix + matrix.transpose()));
  StiffestMode mode;
  mode.converged = solver.info() == Eigen::Success;
  if (!mode.converged) return mode;
  mode.value = solver.eigenvalues().tail<1>()[0];
  mode.smallest = solver.eigenvalues()[0];
  s.apply(solver.eigenvectors().rightCols<1>(), column);
  mode.residual = (column - mode.value * solver.eigenvectors().rightCols<1>()).stableNorm();
  return mode;
}

StiffestMode arpack_spectrum(const LinearOperator& s, const ArpackOptions& options) {
  const SymmetricEigenpairs pairs = largest_eigenpairs(s, 1, options);
  StiffestMode mode;
  mode.converged = pairs.converged;
  mode.products = pairs.products;
  if (!pairs.converged) return mode;
  mode.value = pairs.values[0];
  mode.residual = pairs.residuals[0];
  return mode;
}

// A bound on how far the factorization's rounding may have moved the eigenvalues: Σ γ(l_i + 2) a_ii, where
// l_i counts row i of the factor (Rump 2006, Verification of positive definiteness, BIT 46).
double factorization_error(const Cholesky& factor, double largest_diagonal) {
  const SparseMatrix& l = factor.matrixL().nestedExpression();
  return 1.01 * unit_roundoff * static_cast<double>(l.nonZeros() + 2 * l.rows()) * largest_diagonal;
}

}  // namespace

// With a diagonal mass it is a matrix; else L⁻¹ P K Pᵀ L⁻ᵀ with P M Pᵀ = LLᵀ.
LinearOperator scaled_stiffness(const StructuralMatrices& s) {
  if (is_diagonal(s.mass)) {
    const auto matrix = std::make_shared<SparseMatrix>(scaled(s.stiffness, inverse_root_mass(s)));
    return {s.size(),
            [matrix](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out.noalias() = *matrix * in; }};
  }
  const auto mass = std::make_shared<Cholesky>(s.mass);
  return {s.size(), [mass, &s](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
            out = mass->permutationPinv() * mass->matrixU().solve(in);
            out = mass->permutationP() * (s.stiffness * out).eval();
            mass->matrixL().solveInPlace(out);
          }};
}

bool is_below(const StructuralMatrices& s, double sigma) {
  const Eigen::VectorXd d = inverse_root_mass(s);
  const SparseMatrix mass = scaled(s.mass, d), stiffness = scaled(s.stiffness, d);
  const SparseMatrix a = sigma * mass - stiffness;
  const double forming_error =
      8 * unit_roundoff * (std::abs(sigma) * largest_row_sum(mass) + largest_row_sum(stiffness));
  const double largest_diagonal = Eigen::VectorXd(a.diagonal()).maxCoeff();
  if (!std::isfinite(forming_error) || !(largest_diagonal > 0)) return false;

  SparseMatrix identity(s.size(), s.size());
  identity.setIdentity();
  Cholesky factor;
  factor.analyzePattern(a);
  double shift = forming_error;
  for (int attempt = 0; attempt < 3; ++attempt) {  // the shift depends on the factor, a little
    factor.factorize(a - shift * identity);
    if (factor.info() != Eigen::Success) return false;
    const double needed = forming_error + factorization_error(factor, largest_diagonal);
    if (shift >= needed) return true;
    shift = 1.1 * needed;
  }
  return false;
}

StiffestMode estimated_stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options) {
  const LinearOperator op = scaled_stiffness(s);
  StiffestMode mode = s.size() <= dense_limit ? dense_spectrum(op) : arpack_spectrum(op, options);
  mode.upper_bound = std::numeric_limits<double>::infinity();
  return mode;
}

StiffestMode stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options) {
  StiffestMode mode = estimated_stiffest_mode(s, options);
  if (is_diagonal(s.mass)) {
    const SparseMatrix matrix = scaled(s.stiffness, inverse_root_mass(s));
    mode.upper_bound = largest_row_sum(matrix) * (1 + 8 * unit_roundoff * static_cast<double>(s.size()));
  }
  if (!mode.converged || s.size() > factorization_limit) return mode;

  const double scale = std::abs(mode.value);
  if (scale == 0) return mode;
  double gap = std::max(mode.residual, 1e-10 * scale);
  while (mode.value + gap < mode.upper_bound && !is_below(s, mode.value + gap)) gap *= 8;
  if (mode.value + gap < mode.upper_bound) {
    mode.upper_bound = mode.value + gap;
    mode.bound_kind = BoundKind::inertia;
  }
  mode.indefinite = Cholesky(s.stiffness + 1e-9 * scale * s.mass).info() != Eigen::Success;
  return mode;
}

}  // namespace springstab
