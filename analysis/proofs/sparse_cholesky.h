// Whether symmetric matrices of one pattern have Cholesky factorizations in floating point; the pattern is
// analyzed once. Large matrices go to CHOLMOD where it was there when this was built, the others to Eigen.
#pragma once

#include <memory>

#include "solvers/linear/structural_matrices.h"

namespace springstab {

class SparseCholesky {
 public:
  SparseCholesky();
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;

  /// From as many unknowns blocks are faster; never without CHOLMOD.
  static const Eigen::Index blocked_from;
  /// Beyond as many unknowns nothing is analyzed.
  static const Eigen::Index unknowns_limit;
  /// Beyond as many entries of L, 1 GB with what pads them, nothing is factorized.
  static constexpr double entries_limit = 1e8;

  /// Of the pattern that all matrices have, compressed, both triangles stored; nothing is done at a second
  /// call. False where a factorization would be too large.
  bool analyze(const SparseMatrix& pattern);
  /// Entries of L, its diagonal with them; after an analysis.
  double entries() const;
  /// A bound e on rounding: what is factorized is A + ΔA with -e diag(A) <= ΔA <= e diag(A).
  double error() const;

  /// True if every pivot is positive and finite. Analyzes where that was not done.
  bool factorize(const SparseMatrix& a);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

/// Whether CHOLMOD was there when this was built.
bool has_cholmod();

}  // namespace springstab
