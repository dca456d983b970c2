// Sparse Cholesky factorization H = LLᵀ of a symmetric matrix of 3x3 blocks. The rows are put into an order
// of approximate minimum degree (Eigen's), the pattern of L is found once and for all, and row k of L is the
// solution of a triangular system with the rows above it, along the elimination tree (T. Davis, Direct
// Methods for Sparse Linear Systems, 2006, sections 4.1 and 4.7). Beside Eigen's factorizations of single
// numbers this one has an index for nine of them, four at a time are worked on, and it allocates nothing
// after the pattern.
#pragma once

#include <vector>

#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/system.h"

namespace springstab {

class BlockCholesky {
 public:
  /// Factorizes H = m M + k K + c C, all symmetric, C if it is not null. False where a pivot shows that H is
  /// not positive definite. The patterns must stay those of the first call, which alone allocates.
  bool factorize(double m, const std::vector<double>& mass, double k, const BlockSparseMatrix& stiffness,
                 double c, const BlockSparseMatrix* damping);

  /// H y = b, after a factorization that succeeded. Three numbers per row.
  void solve(const Vector& b, Vector& y);

  /// Blocks of L below its diagonal.
  long blocks() const { return static_cast<long>(row_.size()); }

 private:
  /// What a matrix has in the columns of H above the diagonal and on it, in the new numbers.
  class Columns {
   public:
    void set(const BlockSparseMatrix& matrix, const std::vector<int>& place);
    /// to += factor · column k; to has 12 numbers per block, rows of four.
    void add(int k, double factor, const BlockSparseMatrix& matrix, std::vector<double>& to) const;

   private:
    struct Entry {
      int row;
      bool transposed;
      long block;
    };
    std::vector<long> start_;
    std::vector<Entry> entries_;
  };

  void set_pattern(const BlockSparseMatrix& stiffness, const BlockSparseMatrix* damping);
  int rows() const { return static_cast<int>(order_.size()); }
  template <class Visit>
  void for_each_in_row_of_l(int k, const Visit& visit);

  std::vector<int> order_, place_;  // new -> old and old -> new number of a row
  Columns stiffness_, damping_;
  std::vector<int> parent_;        // in the elimination tree, -1 at a root
  std::vector<long> above_start_;  // what H has above its diagonal, by columns in the new numbers
  std::vector<int> above_;
  std::vector<long> start_, end_;  // the columns of L below the diagonal, as far as they are filled
  std::vector<int> row_;
  std::vector<double> value_;          // 9 per block, row by row
  std::vector<double> inverse_pivot_;  // L_kk⁻¹, likewise
  std::vector<double> column_;         // of H on its way to a row of L: 12 per block, rows of four
  std::vector<int> visited_, path_, reach_;
  Vector solution_;
};

}  // namespace springstab
