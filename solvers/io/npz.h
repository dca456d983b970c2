// Sparse matrices as SciPy's save_npz writes them: NumPy's arrays in a ZIP archive.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <string_view>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Parses matrices in compressed rows, in compressed columns or by coordinates (csr, csc, coo), of real
/// numbers, integers or truth values. Throws InputError for other forms, for arrays that do not go together,
/// and for numbers that are not finite.
Eigen::SparseMatrix<double> parse_npz(const std::string& source, std::string_view bytes,
                                      Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
