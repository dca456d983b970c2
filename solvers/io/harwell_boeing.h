// Harwell-Boeing format (Duff, Grimes and Lewis, Users' Guide for the Harwell-Boeing Sparse Matrix
// Collection, 1992) and its successor Rutherford-Boeing: a header that gives Fortran formats, then column
// pointers, row indices and values in fields of fixed width.
#pragma once

#include <Eigen/SparseCore>
#include <string_view>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Whether lines 3 and 4 of the text look like this format's: a three-letter type and parenthesized formats.
bool looks_like_harwell_boeing(std::string_view text);

/// Parses assembled square real (or integer) matrices: types RSA, RUA, RZA, ISA, IUA, IZA in either case;
/// symmetric and skew-symmetric ones are expanded. Right-hand sides are skipped. Throws InputError, naming
/// `source` and the line, for everything else, and before it allocates more than the text can back.
Eigen::SparseMatrix<double> parse_harwell_boeing(std::string_view source, std::string_view text,
                                                 Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
