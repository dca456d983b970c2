// Proofs by Cholesky factorization that a matrix is positive definite in spite of rounding.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "analysis/proofs/sparse_cholesky.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// Whether c M - a D - b K is proved to be positive definite. No proof is no proof of the contrary.
using DefinitenessTest = std::function<bool(double c, double a, double b)>;

/// Proofs for one structure, with one symbolic factorization for all its proofs.
class Pieces;

class DefinitenessProof {
 public:
  /// Works on the matrices scaled so that the mass has a unit diagonal. Where SparseCholesky finds too many
  /// unknowns the proof is by pieces, which overlap enough for σ I - K to be proved at a σ about `loss` k0
  /// above k0, and no matrix beside those given is kept; without CHOLMOD only diagonally dominant matrices
  /// are proved there.
  explicit DefinitenessProof(StructuralMatrices s, double loss = usual_loss);
  static constexpr double usual_loss = 2e-3;
  /// Of matrices that must outlive it.
  DefinitenessProof(const SparseMatrix& stiffness, const SparseMatrix& mass,
                    const SparseMatrix* damping = nullptr, double loss = usual_loss);
  /// The same of a structure's, which are not copied.
  explicit DefinitenessProof(const StructuralMatrices* s)
      : DefinitenessProof(s->stiffness, s->mass, s->has_damping() ? &s->damping : nullptr) {}

  /// Of a structure whose matrices are distributed: `s`, which must outlive it, are rows and columns of it,
  /// those that `own` pieces and their neighbours need (Pieces), and `all_of` says whether something is true
  /// of everybody, who is asked the same in the same order. What holds() says is of the whole structure.
  DefinitenessProof(const StructuralMatrices& s, std::shared_ptr<const Pieces> own,
                    std::function<bool(bool)> all_of);

  /// A DefinitenessTest.
  bool holds(double c, double a, double b);
  /// The same; this object must outlive it.
  DefinitenessTest test() {
    return [this](double c, double a, double b) { return holds(c, a, b); };
  }

  /// Whether matrices of this pattern are factorized at once. Analyzes it.
  bool factorizes();
  /// Into how many pieces; 0 where none was needed so far.
  int pieces() const;

  /// Whether K has no eigenvalue below zero but for rounding: see is_semidefinite. Found out once.
  bool stiffness_is_semidefinite();

 private:
  /// c M - a D - b K.
  struct Sum {
    double c, a, b;
  };
  /// Of a column of it: the diagonal, the absolute sum, and what its forming may be off by.
  struct Column {
    double diagonal = 0, size = 0, error = 0;
  };
  struct Columns {
    Eigen::VectorXd diagonal, size, error;
  };

  void take_matrices();
  Column form(const Sum& sum, Eigen::Index j, double* values) const;
  Columns measure(const Sum& sum) const;
  void form_whole(const Sum& sum, const Eigen::VectorXd& added);
  bool in_pieces(const Sum& sum, const Columns& columns);
  bool all_of(bool mine) const { return all_of_ ? all_of_(mine) : mine; }

  std::unique_ptr<const StructuralMatrices> own_;
  std::unique_ptr<const SparseMatrix> widened_;       // K, with an entry wherever one of them has
  const SparseMatrix *stiffness_, *mass_, *damping_;  // the last: null without damping
  Eigen::VectorXd root_;                              // 1/√M_ii
  SparseMatrix matrix_;                               // what is factorized at once
  SparseCholesky cholesky_;
  [[maybe_unused]] double loss_;  // where there is no CHOLMOD
  std::optional<bool> stiffness_is_semidefinite_;
  std::shared_ptr<const Pieces> pieces_;
  std::function<bool(bool)> all_of_;  // of a distributed structure
};

/// Whether a symmetric matrix has no eigenvalue below zero but for rounding: of 1e-9 of the diagonal, unknown
/// by unknown, and of 1e-13 of the largest entry of M^-½ A M^-½. By a Cholesky factorization.
bool is_semidefinite(const SparseMatrix& a, const SparseMatrix& mass);

}  // namespace springstab
