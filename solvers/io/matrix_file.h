// A matrix from a file, whatever its format.
#pragma once

#include <Eigen/SparseCore>
#include <string>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Reads a real sparse matrix of any shape; symmetric and skew-symmetric ones come with both triangles.
/// The contents decide the format (a ZIP archive is SciPy's, PETSc's has a number, Matrix Market's a banner,
/// and Harwell-Boeing's headers and Abaqus' entries show themselves); a suffix
/// (.mtx, .mm; .hb, .rb, .rsa, .rua and their kin) only decides which format's rules an unclear file is
/// judged by. Throws InputError with the line, also for a file of no such format.
Eigen::SparseMatrix<double> read_matrix(const std::string& path, Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
