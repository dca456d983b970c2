// OpenBLAS as it is used here. Where another BLAS is linked, which ARPACK brought with it, that is left as it
// is.
#pragma once

namespace springstab {

/// One BLAS thread: the matrices here are sparse, what is dense of them is small, and sums must not depend on
/// the number of cores.
void use_one_blas_thread();

/// OpenBLAS has kernels for each kind of processor, and takes those of 2004 on one that is newer than itself,
/// which multiplies matrices at a fifth of the speed. Then this chooses those for its instructions, as the
/// environment variable OPENBLAS_CORETYPE does, which is obeyed if it is set. For the beginning of a program:
/// no other thread may be in a BLAS function.
void use_fast_blas_kernels();

}  // namespace springstab
