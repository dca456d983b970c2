#include "experiments/mpi/agreement.h"

#include <unistd.h>

#include <cstdio>
#include <new>
#include <stdexcept>

#include "experiments/command/options.h"
#include "experiments/mpi/petsc.h"
#include "solvers/io/input_error.h"

namespace springstab::mpi {
namespace {

constexpr char no_memory[] = "not enough memory for this input";

bool agreed = false;  // that what is being thrown is thrown everywhere

struct Failure {
  int status = done;
  std::string line{};
};

// Of the exception that is being handled.
Failure current_failure() {
  try {
    throw;
  } catch (const InputError& error) {
    return {bad_input, error.what()};
  } catch (const std::invalid_argument& error) {
    return {bad_input, error.what()};
  } catch (const std::bad_alloc&) {
    return {bad_input, no_memory};
  } catch (const PetscFailure& error) {
    return {error.by_user ? bad_input : internal_error, error.what()};
  } catch (const std::exception& error) {
    return {internal_error, error.what()};
  }
}

[[noreturn]] void throw_everywhere(const Failure& failure) {
  agreed = true;
  if (failure.line == no_memory) throw std::bad_alloc();
  if (failure.status == bad_input) throw std::invalid_argument(failure.line);
  throw std::runtime_error(failure.line);
}

// Who failed first in a call that all take part in should be heard first.
[[noreturn]] void end_all(const Failure& failure) {
  if (rank() > 0) sleep(1);
  std::fprintf(stderr, "springstab-mpi: rank %d: %s\n", rank(), failure.line.c_str());
  std::fflush(stderr);
  MPI_Abort(PETSC_COMM_WORLD, failure.status);
  std::abort();
}

}  // namespace

int rank() {
  int number = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &number);
  return number;
}

int ranks() {
  int count = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &count);
  return count;
}

bool all_of(bool mine) {
  int value = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  return value == 1;
}

void together(const std::function<void()>& work) {
  Failure failure;
  try {
    work();
  } catch (...) {
    failure = current_failure();
  }
  int first = failure.status == done ? ranks() : rank();
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  if (first == ranks()) return;
  int told[2] = {failure.status, static_cast<int>(failure.line.size())};
  MPI_Bcast(told, 2, MPI_INT, first, PETSC_COMM_WORLD);
  failure.status = told[0];
  failure.line.resize(static_cast<std::size_t>(told[1]));
  MPI_Bcast(failure.line.data(), told[1], MPI_CHAR, first, PETSC_COMM_WORLD);
  throw_everywhere(failure);
}

int guarded(const std::function<int()>& work) {
  try {
    return work();
  } catch (...) {
    if (agreed) throw;
    end_all(current_failure());
  }
}

}  // namespace springstab::mpi
