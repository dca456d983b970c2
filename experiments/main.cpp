#include <malloc.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "analysis/blas.h"
#include "experiments/command/command_line.h"
#include "experiments/command/options.h"

int main(int argc, char** argv) {
  springstab::end_blas_threads(argv);
#ifdef M_MMAP_MAX
  // Large matrices come and go: a fifth of a proof's time went into fresh pages.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
  const int status = springstab::run_command(argc, argv);
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout && !std::ferror(stdout)) return status;
  std::cerr << "springstab: stdout: cannot be written: " << std::strerror(errno ? errno : EIO) << '\n';
  return status == springstab::done ? springstab::bad_input : status;
}
