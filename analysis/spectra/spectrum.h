// The stiffest mode of a structure: k0, the largest eigenvalue of K' = M⁻¹K, with a bound that is proved.
// Everything is computed on S = M^(-1/2) K M^(-1/2) (or L⁻¹KL⁻ᵀ with M = LLᵀ), which is symmetric and has the
// eigenvalues of K'.
//
//     const StiffestMode k0 = stiffest_mode(prepare(stiffness, mass));
//     if (!k0.converged) throw std::runtime_error("k0 is not known");
//     const double limit = 2 / std::sqrt(k0.value);             // symplectic Euler's, undamped [s]
//     const double certified = 2 / std::sqrt(k0.upper_bound);   // a step below it [s]
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "analysis/spectra/arpack.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Where an upper bound on k0 comes from.
enum class BoundKind {
  inertia,     // a Cholesky factorization of σI - S minus a shift for its rounding exists, so k0 < σ
  pieces,      // likewise, of pieces that overlap (analysis/proofs/pieces.h)
  gershgorin,  // the largest absolute row sum of S
};

struct StiffestMode {
  bool converged = false;
  double value = 0;     // never above k0 but for rounding: a Ritz value where `smallest` is absent [1/s²]
  double residual = 0;  // ‖S u - value u‖ for the unit vector u: some eigenvalue is this close
  double gershgorin =
      std::numeric_limits<double>::infinity();  // k0 is not larger: row sums; ∞ with consistent masses
  double upper_bound = 0;                       // the least proved bound on k0
  BoundKind bound_kind = BoundKind::gershgorin;
  long products = 0;               // with S; 0 when solved densely
  std::optional<double> smallest;  // k_min where the whole spectrum was computed [1/s²]
  bool indefinite = false;         // some eigenvalue is below -1e-9 k0: the structure itself is unstable
  std::optional<double> lowest;  // where K is indefinite: its smallest eigenvalue, if that converged [1/s²]
};

/// Up to as many unknowns eigenvalues are computed densely.
inline constexpr Eigen::Index dense_limit = 150;

/// M^(-1/2) A M^(-1/2), or L⁻¹AL⁻ᵀ with M = LLᵀ, as an operator, which may refer to `a`.
LinearOperator mass_scaled(const SparseMatrix& a, const SparseMatrix& mass);

/// A symmetric matrix as an operator, its eigenvalues bounded by Gershgorin's discs.
LinearOperator symmetric_operator(SparseMatrix a);

/// S as an operator, which may refer to `s`.
LinearOperator scaled_stiffness(const StructuralMatrices& s);

/// The matrix of an operator, column by column.
Eigen::MatrixXd as_dense(const LinearOperator& a);

/// (A + Aᵀ)/2.
Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& a);

/// k0 of `s`, densely up to 150 unknowns, else by ARPACK. Where K is not symmetric it is the largest |λ|,
/// bounded by Gershgorin alone, and `smallest`, found up to 400 unknowns, the least real part. What is too
/// large to be factorized at once (SparseCholesky) is bounded by pieces, which lose about `loss` of k0,
/// without CHOLMOD by Gershgorin alone, and its definiteness is not tested.
StiffestMode stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options = {},
                           double loss = 2e-3);

/// The same without a proof, which costs more than k0 itself: the bound is ∞, definiteness is not tested.
StiffestMode estimated_stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options = {});

/// Tests definiteness, of a symmetric K that can be factorized at once: sets `indefinite` and `lowest`.
void find_lowest(const StructuralMatrices& s, const ArpackOptions& options, StiffestMode& mode);

/// Takes the bound of a mode that was found down to value + gap, or as little more as is proved: gaps grow
/// until `proves` that k0 is below. `kind` says by what, once that was tried.
void tighten_bound(StiffestMode& mode, double gap, const std::function<bool(double sigma)>& proves,
                   const std::function<BoundKind()>& kind);

/// Whether a Cholesky factorization proves that every eigenvalue of K' is below sigma.
bool is_below(const StructuralMatrices& s, double sigma);

}  // namespace springstab
