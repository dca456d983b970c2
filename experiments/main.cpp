#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "experiments/command/command_line.h"
#include "experiments/command/options.h"

int main(int argc, char** argv) {
  const int status = springstab::run_command(argc, argv);
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout && !std::ferror(stdout)) return status;
  std::cerr << "springstab: stdout: cannot be written: " << std::strerror(errno ? errno : EIO) << '\n';
  return status == springstab::done ? springstab::bad_input : status;
}
