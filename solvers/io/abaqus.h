// Sparse matrices as Abaqus writes them into .mtx files (*MATRIX OUTPUT): lines of numbers, without a size.
#pragma once

#include <Eigen/SparseCore>
#include <string_view>

#include "solvers/io/matrix_builder.h"

namespace springstab {

/// Whether the first line that is neither a comment (**) nor a keyword (*MATRIX ...) is an entry of such a
/// file.
bool looks_like_abaqus(std::string_view text);

/// Parses entries "node, degree of freedom, node, degree of freedom, value" (FORMAT=MATRIX INPUT) or "row
/// column value" (FORMAT=COORDINATE), with commas or blanks between them. Of nodes the degrees of freedom
/// that occur are numbered in their order; so a stiffness and a mass matrix go together where they have the
/// same ones. A file with entries on one side of the diagonal only is symmetric. Throws InputError, with the
/// line, for all else.
Eigen::SparseMatrix<double> parse_abaqus(std::string_view source, std::string_view text,
                                         Duplicates duplicates = Duplicates::refused);

}  // namespace springstab
