// A matrix from a file, whatever its format.
#pragma once

#include <Eigen/SparseCore>
#include <string>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Reads a real sparse matrix of any shape; symmetric and skew-symmetric ones come with both triangles.
/// The contents decide the format (Matrix Market's banner, or a header like Harwell-Boeing's); a suffix
/// (.mtx, .mm; .hb, .rb, .rsa, .rua and their kin) only decides which format's rules an unclear file is
/// judged by. Throws InputError with the line, also for a file of neither format.
Eigen::SparseMatrix<double> read_matrix(const std::string& path, Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
