// OpenBLAS as it is used here. Another BLAS, which ARPACK brought with it, is left as it is.
//
// OpenBLAS has kernels for each kind of processor, and on one that is newer than itself takes those of 2004,
// which multiply matrices at a fifth of the speed. When this is loaded, before anything is computed, those
// are replaced by the ones for the instructions that there are, as the environment variable OPENBLAS_CORETYPE
// does, which is obeyed if it is set.
#pragma once

namespace springstab {

/// One BLAS thread: the matrices here are sparse, what is dense of them is small, and sums must not depend on
/// the number of cores.
void use_one_blas_thread();

/// For a program that calls BLAS from its own threads alone, before anything else: ends the threads that
/// OpenBLAS starts when it is loaded, which look for work for some 100 ms. Each asks for 128 MB of address
/// space until it has them; where that is limited it may never have, nor end: the program begins anew, with
/// OPENBLAS_NUM_THREADS=1.
void end_blas_threads(char** argv);

}  // namespace springstab
