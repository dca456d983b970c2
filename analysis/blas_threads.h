// One BLAS thread: the matrices here are sparse, what is dense of them is small, and sums must not depend on
// the number of cores.
#pragma once

#ifdef SPRINGSTAB_CHOLMOD
extern "C" void openblas_set_num_threads(int);
#endif

namespace springstab {

/// Where OpenBLAS is linked; another BLAS, which ARPACK brought with it, is left as it is.
inline void use_one_blas_thread() {
#ifdef SPRINGSTAB_CHOLMOD
  openblas_set_num_threads(1);
#endif
}

}  // namespace springstab
