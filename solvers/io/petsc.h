// Sparse matrices in PETSc's binary format, as MatView writes an AIJ matrix: big endian, compressed rows.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <string_view>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Whether it begins with the number that PETSc gives matrices, in 32 or 64 bits.
bool is_petsc_matrix(std::string_view beginning);

/// Parses one matrix of real numbers of 64 bits, its integers of 32 bits or 64. Throws InputError, with the
/// byte, for anything else, and before anything is allocated that the file cannot back.
Eigen::SparseMatrix<double> parse_petsc(const std::string& source, std::string_view bytes,
                                        Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
