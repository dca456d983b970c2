// springstab-mpi: `springstab limits` on many processes, as `mpirun -np N springstab-mpi limits …`. Words of
// one dash are PETSc's and SLEPc's options, with their values.
#include <malloc.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iostream>
#include <vector>

#include "analysis/blas.h"
#include "experiments/command/command_line.h"
#include "experiments/command/options.h"
#include "experiments/mpi/agreement.h"
#include "experiments/mpi/limits.h"
#include "experiments/mpi/petsc.h"

namespace {

bool is_petscs(const char* word) {
  return word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) && word[2] != '\0';
}

// The command's words, and those that begin with one of PETSc's options and end before the next of ours: such
// an option's value is no option.
struct Words {
  std::vector<char*> ours, petscs;

  Words(int argc, char** argv) : ours{argv[0]}, petscs{argv[0]} {
    for (int i = 1; i < argc; ++i) {
      if (!is_petscs(argv[i])) {
        ours.push_back(argv[i]);
        continue;
      }
      petscs.push_back(argv[i]);
      if (i + 1 < argc && argv[i + 1][0] != '-') petscs.push_back(argv[++i]);
    }
  }
};

springstab::Subcommand limits() {
  springstab::Subcommand limits = springstab::limits_command(springstab::mpi::run_distributed_limits);
  limits.footer =
      "As springstab limits, of matrices that are distributed over the ranks: its --help says what the "
      "numbers "
      "mean.\n"
      "Words of one dash and what follows them go to PETSc and SLEPc: -eps_ncv 40, -log_view :log.txt.\n\n"
      "example: mpirun -np 2 springstab-mpi limits --grid 100x100 --pin first-row";
  return limits;
}

// What MPI's libraries forbid, lest memory that a network card knows moves: matrices that are done with would
// stay beside those that follow.
void give_memory_back() {
#ifdef __GLIBC__
  constexpr int large = 1 << 20;  // [bytes]
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, large);
  mallopt(M_TRIM_THRESHOLD, large);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  springstab::end_blas_threads(argv);
  Words words(argc, argv);
  int count = static_cast<int>(words.petscs.size());
  words.petscs.push_back(nullptr);
  char** petscs = words.petscs.data();
  if (SlepcInitialize(&count, &petscs, nullptr, nullptr) != 0) return springstab::internal_error;
  give_memory_back();
  springstab::mpi::keep_petsc_errors();
  if (springstab::mpi::rank() > 0) {  // one speaks for all
    std::cout.rdbuf(nullptr);
    std::cerr.rdbuf(nullptr);
    if (!std::freopen("/dev/null", "w", stdout)) return springstab::internal_error;
  }
  const int status = springstab::run_command("springstab-mpi", {limits()},
                                             static_cast<int>(words.ours.size()), words.ours.data());
  std::cout.flush();
  SlepcFinalize();
  return status;
}
