// Cholesky factorizations by dense blocks: CHOLMOD's supernodal ones, ordered by METIS, over a BLAS of one
// thread. Built where CHOLMOD is (SPRINGSTAB_CHOLMOD); whoever factorizes asks SparseCholesky.
#pragma once

#include <Eigen/SparseCore>
#include <memory>

namespace springstab {

class SupernodalCholesky {
 public:
  /// Analyzes the pattern of a symmetric matrix, both triangles stored.
  explicit SupernodalCholesky(const Eigen::SparseMatrix<double>& pattern);
  ~SupernodalCholesky();

  /// Whether `a`, of that pattern, has a factorization in floating point: false as well where a number is not
  /// finite or memory ran out.
  bool factorize(const Eigen::SparseMatrix<double>& a);

  /// Entries of L, its diagonal with them; ∞ where memory ran out in the analysis.
  double entries() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace springstab
