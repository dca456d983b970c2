// Rows of a matrix of 3x3 blocks, gathered from the matrices of parts of a scene, to become a distributed
// one.
#pragma once

#include <vector>

#include "experiments/mpi/petsc.h"
#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/team.h"

namespace springstab::mpi {

class BlockRows {
 public:
  /// How many rows there will be: from what the first ones take, memory is set aside for all.
  void expect(long rows) { expected_ = rows; }

  /// Appends the rows of `part` whose particle has one of the `own` numbers, in their order there; number[i]
  /// is that of its row i, among all free particles. Each call takes up where the last one ended.
  void append(const BlockSparseMatrix& part, const std::vector<long>& number, const IndexRange& own);

  /// Appends rows without blocks.
  void append_empty(std::size_t rows) { start_.insert(start_.end(), rows, start_.back()); }

  /// The rows of all ranks, `all` in all; nothing is left here.
  OwnedMat assemble(long all) &&;

 private:
  std::vector<PetscInt> start_{0}, column_;
  std::vector<double> value_;  // 9 a block, row by row
  long expected_ = 0;
};

}  // namespace springstab::mpi
