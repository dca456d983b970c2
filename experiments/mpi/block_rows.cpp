#include "experiments/mpi/block_rows.h"

namespace springstab::mpi {

void BlockRows::append(const BlockSparseMatrix& part, const std::vector<long>& number,
                       const IndexRange& own) {
  // Calls visit(row, column, place, transposed) for the blocks of own rows, above the diagonal, too.
  const auto for_each = [&](const auto& visit) {
    for (int i = 0; i < part.rows(); ++i)
      for (long place = part.row_begin(i); place <= part.diagonal(i); ++place) {
        const int j = part.column(place);
        if (own.holds(number[i])) visit(i, j, place, false);
        if (i != j && own.holds(number[j])) visit(j, i, place, true);
      }
  };
  std::vector<long> next(static_cast<std::size_t>(part.rows()), 0);
  for_each([&](int row, int, long, bool) { ++next[row]; });
  long end = start_.back();
  for (int i = 0; i < part.rows(); ++i) {
    if (!own.holds(number[i])) continue;
    const long blocks = next[i];
    next[i] = end;
    end += blocks;
    start_.push_back(static_cast<PetscInt>(end));
  }
  const auto rows = static_cast<double>(start_.size() - 1);
  if (static_cast<std::size_t>(end) > column_.capacity() && static_cast<double>(expected_) > rows) {
    const double all = static_cast<double>(end) * static_cast<double>(expected_) / rows;
    column_.reserve(static_cast<std::size_t>(1.01 * all));
    value_.reserve(static_cast<std::size_t>(9 * 1.01 * all));
  }
  column_.resize(static_cast<std::size_t>(end));
  value_.resize(9 * static_cast<std::size_t>(end));
  for_each([&](int row, int column, long place, bool transposed) {
    const long at = next[row]++;
    column_[at] = static_cast<PetscInt>(number[column]);
    const double* const from = part.block(place);
    double* const to = &value_[9 * at];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) to[3 * r + c] = transposed ? from[3 * c + r] : from[3 * r + c];
  });
}

OwnedMat BlockRows::assemble(long all) && {
  const auto rows = static_cast<PetscInt>(3 * (start_.size() - 1));
  OwnedMat a;
  petsc(MatCreate(PETSC_COMM_WORLD, a.out()));
  petsc(MatSetType(a, MATBAIJ));
  petsc(MatSetSizes(a, rows, rows, static_cast<PetscInt>(3 * all), static_cast<PetscInt>(3 * all)));
  petsc(MatSetBlockSize(a, 3));
  petsc(MatSetFromOptions(a));
  // Of these two one is for the type at hand, and the other does nothing.
  petsc(MatSeqBAIJSetPreallocationCSR(a, 3, start_.data(), column_.data(), value_.data()));
  petsc(MatMPIBAIJSetPreallocationCSR(a, 3, start_.data(), column_.data(), value_.data()));
  *this = {};
  return a;
}

}  // namespace springstab::mpi
