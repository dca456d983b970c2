// From the entries that a matrix file lists to a sparse matrix: the rules that all matrix formats share.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "solvers/io/text_file.h"
#include "solvers/team.h"

namespace springstab {

/// What a file leaves out. Symmetric: entries above the diagonal, or those below; skew-symmetric: the
/// diagonal as well.
enum class Symmetry { general, symmetric, skew_symmetric };

/// What becomes of several entries at one position.
enum class Duplicates { refused, summed };

/// Rows of a matrix that is too large to be held as a whole.
struct MatrixRows {
  long first;                                        // of them
  long all_rows, columns;                            // of the matrix
  Eigen::SparseMatrix<double, Eigen::RowMajor> own;  // from row `first` on
};

/// Collects entries in any order. A symmetric or skew-symmetric matrix must be square.
class MatrixBuilder {
 public:
  MatrixBuilder(std::string source, int rows, int columns, Symmetry symmetry);
  /// Of these rows alone.
  MatrixBuilder(std::string source, int rows, int columns, Symmetry symmetry, const IndexRange& own);

  void reserve(std::size_t entries) { entries_.reserve(entries); }

  /// Adds the entry of a 1-based position. Throws InputError at `line` for a position outside the matrix and
  /// for an entry other than 0 on a skew-symmetric matrix's diagonal.
  void add(long line, long long row, long long column, double value);

  /// The matrix with both triangles. Throws InputError, naming both lines, for two entries at one position
  /// (or, with symmetry, at one and its mirror image) if they are refused, or if their sum is not finite.
  Eigen::SparseMatrix<double> build(Duplicates duplicates) &&;
  /// Of the rows asked for, likewise.
  MatrixRows build_rows(Duplicates duplicates) &&;

 private:
  void sort_and_check(Duplicates duplicates);
  void mirror();
  void check_duplicates(Duplicates duplicates) const;

  struct Entry : Eigen::Triplet<double> {
    Entry(int row, int column, double value, long at) : Triplet(row, column, value), line(at) {}
    long line;
  };

  std::string source_;
  int rows_, columns_;
  Symmetry symmetry_;
  IndexRange own_;
  std::vector<Entry> entries_;
};

/// A header of a few bytes must not make anyone allocate gigabytes: a matrix of very many rows needs entries
/// too, for its column pointers cost 4 bytes each. Fails where it has too few.
void check_rows(const Location& at, int rows, int columns, long long entries);

}  // namespace springstab
