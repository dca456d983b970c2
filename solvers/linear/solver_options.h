// How H y = b is solved in an implicit step.
#pragma once

namespace springstab {

enum class SolverKind {
  conjugate_gradients,
  cholesky,  // a sparse factorization, see block_cholesky.h; the other options are not for it
};

enum class Preconditioner {
  block_jacobi,  // the inverse diagonal blocks, as in the paper
  block_ssor,    // see block_ssor.h: less than half the iterations, each no dearer
};

struct SolverOptions {
  SolverKind kind = SolverKind::conjugate_gradients;
  double tolerance = 1e-6;  // on ‖b - Hy‖ in the norm of P⁻¹, relative to that of b
  long max_iterations = 10000;
  Preconditioner preconditioner = Preconditioner::block_ssor;
};

}  // namespace springstab
