// Block SSOR (symmetric successive over-relaxation) for conjugate gradients, as a change of variables
// (Eisenstat 1981; Saad, Iterative Methods for Sparse Linear Systems, §9.2.2). In 3x3 blocks let
// H = L + D + Lᵀ, D/ω = CCᵀ and L̂ = C⁻¹LC⁻ᵀ. Then C⁻¹HC⁻ᵀ = (1 + L̂) + (1 + L̂ᵀ) - (2 - ω), and conjugate
// gradients run unpreconditioned on
//     Ĥ = (1 + L̂)⁻¹ C⁻¹HC⁻ᵀ (1 + L̂)⁻ᵀ,   ŷ = (1 + L̂)ᵀ Cᵀ y,   b̂ = (1 + L̂)⁻¹ C⁻¹ b,
//     Ĥp = t + (1 + L̂)⁻¹ (p - (2 - ω) t)   with   t = (1 + L̂)⁻ᵀ p,
// which reads L̂ twice: as much memory as one product with H, preconditioner included. pᵀĤp is the curvature
// of H along C⁻ᵀt, so an indefinite H shows as it does without a preconditioner. Whenever the diagonal blocks
// are positive definite so is the preconditioner; unlike an incomplete factorization it cannot break down.
//
// L is what lies below the diagonal in an order that two threads can follow: the rows from both ends inwards,
// and last some in the middle, a bandwidth of them, that keep the two sides from meeting. Stored are the
// blocks below the diagonal of the matrix as it is. From the lower end inwards these are the transposed ones
// of L, and what is a sum over a row on the one side is one over a column on the other. The sides have about
// as many blocks, whatever the number of threads is, and so results do not depend on it. It takes a few
// iterations in a hundred more than one sweep from end to end, and each is shorter on one thread too: where a
// row waits for the one before, there is one of the other side to do.
#pragma once

#include <array>
#include <vector>

#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/linear/four.h"
#include "solvers/system.h"
#include "solvers/team.h"

namespace springstab {

class BlockSsor {
 public:
  /// The relaxation 0 < ω < 2. Over-relaxed, since what makes H hard is smooth: 1.4 to 1.6 measure best on
  /// nets of 16 x 16 to 128 x 128.
  static constexpr double relaxation = 1.5;

  /// Takes H = m M + k K + c C, all symmetric, C if it is not null. False where a diagonal block of H is not
  /// positive definite. The patterns must stay those of the first call, which alone allocates.
  bool set(double m, const std::vector<double>& mass, double k, const BlockSparseMatrix& stiffness, double c,
           const BlockSparseMatrix* damping);

  /// b̂ of b, and y of ŷ. Vectors under a hat have four numbers per particle, the last one zero.
  void transform(const Vector& b, Vector& transformed);
  void transform_back(const Vector& transformed, Vector& y);

  /// out = Ĥ in; returns their scalar product.
  double multiply(const Vector& in, Vector& out);

  /// The rows that come last; those before them ascend, those after them descend.
  const IndexRange& middle() const { return rows_of_[middle_part]; }

 private:
  enum Part { upper_side, lower_side, middle_part };

  void set_pattern(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping);
  void divide();
  int rows() const { return static_cast<int>(row_start_.size()) - 1; }
  bool worth_two_threads() const;
  template <class UpperRow, class LowerRow>
  Four sum_over_sides(const UpperRow& upper_row, const LowerRow& lower_row) const;
  template <class Right, class Take>
  Four solve(const Right& right, const Take& take);
  template <class Right, class Take>
  Four solve_transposed(const Right& right, const Take& take);

  std::array<IndexRange, 3> rows_of_{};  // the parts
  std::vector<long> row_start_;  // L̂, strictly below the diagonal, in compressed rows like BlockSparseMatrix
  std::vector<int> column_;
  std::vector<double> value_;
  std::vector<double> factor_;  // C⁻ᵀ, 12 per row: three rows of four, the last column zero
  Vector solution_, sum_;       // what rows still to come gather from; what was scattered to them, or zeros
};

}  // namespace springstab
