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

namespace springstab {
namespace {

bool choose_kernels() {
#ifdef __x86_64__
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (!gotoblas_dynamic_quit || !gotoblas_dynamic_init || std::getenv(variable)) return false;
  if (std::string_view(openblas_get_corename()) != "Prescott") return false;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  if (!wide && !(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))) return false;
  setenv(variable, wide ? "SkylakeX" : "Haswell", 1);
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
  unsetenv(variable);
  return true;
#else
  return false;
#endif
}

// No thread is in a BLAS function yet: kernels must not change under it.
[[maybe_unused]] const bool chosen = choose_kernels();

}  // namespace

void use_one_blas_thread() { openblas_set_num_threads(1); }

}  // namespace springstab
#else
void springstab::use_one_blas_thread() {}
#endif
