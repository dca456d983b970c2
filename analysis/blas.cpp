#include "analysis/blas.h"

#ifdef SPRINGSTAB_CHOLMOD
#include <cstdlib>
#include <string_view>

extern "C" {
void openblas_set_num_threads(int);
char* openblas_get_corename();
// Not everywhere: of builds for more than one kind of processor, which read the environment variable.
[[gnu::weak]] void gotoblas_dynamic_quit();
[[gnu::weak]] void gotoblas_dynamic_init();
}
#endif

namespace springstab {

void use_one_blas_thread() {
#ifdef SPRINGSTAB_CHOLMOD
  openblas_set_num_threads(1);
#endif
}

void use_fast_blas_kernels() {
#if defined(SPRINGSTAB_CHOLMOD) && defined(__x86_64__)
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (!gotoblas_dynamic_quit || !gotoblas_dynamic_init || std::getenv(variable)) return;
  if (std::string_view(openblas_get_corename()) != "Prescott") return;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  if (!wide && !(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))) return;
  setenv(variable, wide ? "SkylakeX" : "Haswell", 1);
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
  unsetenv(variable);
#endif
}

}  // namespace springstab
