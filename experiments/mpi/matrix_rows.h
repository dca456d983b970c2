// Matrices from files, each rank with its rows: Matrix Market, which every rank scans, and PETSc's binary
// format.
#pragma once

#include <string>

#include "experiments/mpi/petsc.h"
#include "solvers/io/matrix_builder.h"

namespace springstab::mpi {

/// Reads a square matrix. `name` is for messages; `size` is what it must have, 0 for any. A general one must
/// be symmetric to 1e-10 of the larger entry or of √(a_ii a_jj); its symmetric part is what comes. Throws on
/// all ranks.
OwnedMat read_symmetric_rows(const std::string& path, const std::string& name, PetscInt size,
                             Duplicates duplicates);

}  // namespace springstab::mpi
