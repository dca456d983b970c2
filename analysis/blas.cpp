#include "analysis/blas.h"

#ifdef SPRINGSTAB_CHOLMOD
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

extern "C" {
int openblas_get_num_threads();
void openblas_set_num_threads(int);
char* openblas_get_corename();
// Not everywhere: of builds with threads of their own,
[[gnu::weak]] int blas_thread_shutdown_();
// and of those for more than one kind of processor, which read the environment variable.
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

bool is_limited(decltype(RLIMIT_AS) resource) {
  rlimit limit{};
  return getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

void use_one_blas_thread() {
  if (openblas_get_num_threads() > 1) openblas_set_num_threads(1);  // which starts those that were ended
}

void end_blas_threads(char** argv) {
  if (!blas_thread_shutdown_) return;
  if (!is_limited(RLIMIT_AS) && !is_limited(RLIMIT_DATA)) {
    use_one_blas_thread();
    blas_thread_shutdown_();
    return;
  }
  constexpr const char* variable = "OPENBLAS_NUM_THREADS";
  const char* const number = std::getenv(variable);
  if (number && std::string_view(number) == "1") return;
  setenv(variable, "1", 1);
  execv("/proc/self/exe", argv);
}

}  // namespace springstab
#else
void springstab::use_one_blas_thread() {}
void springstab::end_blas_threads(char**) {}
#endif
