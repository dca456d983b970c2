// Matrix Market exchange format, https://math.nist.gov/MatrixMarket/formats.html: a banner, comments, a size
// line, then one entry per line.
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <string_view>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Whether the text begins with the format's banner, `%%MatrixMarket`.
bool has_matrix_market_banner(std::string_view text);

/// Parses coordinate and array matrices, real or integer (a promise that is not held against the values);
/// general, symmetric or skew-symmetric, which are expanded, whichever triangle is given. Numbers may have
/// Fortran's exponents, and a line a comment behind its words. Entries stored as zero stay in a coordinate
/// matrix's pattern; an array matrix keeps what is not 0. Throws InputError, naming `source` and the line,
/// for everything else, and before it allocates more than the text can back.
Eigen::SparseMatrix<double> parse_matrix_market(std::string_view source, std::string_view text,
                                                Duplicates duplicates = Duplicates::refused);

/// The same of some rows: those that `rows_of` says once the number of rows is known. Nothing else is kept.
MatrixRows parse_matrix_market_rows(std::string_view source, std::string_view text,
                                    const std::function<IndexRange(int rows)>& rows_of,
                                    Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
