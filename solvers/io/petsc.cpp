#include "solvers/io/petsc.h"

#include <limits>
#include <vector>

#include "solvers/io/binary_reader.h"

namespace springstab {
namespace {

constexpr std::string_view petsc_matrix("\x00\x12\x7B\x50", 4),
    petsc_matrix_64("\0\0\0\0\x00\x12\x7B\x50", 8);

}  // namespace

bool is_petsc_matrix(std::string_view beginning) {
  return beginning.starts_with(petsc_matrix) || beginning.starts_with(petsc_matrix_64);
}

/// The number of matrices; rows, columns and entries; of each row how many; their columns; their values.
Eigen::SparseMatrix<double> parse_petsc(const std::string& source, std::string_view bytes,
                                        Duplicates duplicates) {
  const NumberType integer = bytes.starts_with(petsc_matrix_64) ? NumberType::i64 : NumberType::i32;
  const std::size_t size = bytes_of(integer);
  BinaryReader reader(source, bytes, std::endian::big);
  if (!is_petsc_matrix(bytes)) reader.at().fail("does not begin as a matrix of PETSc's, expected 1211216");
  reader.take(size, "1211216");
  const Location at = reader.at();
  const long long rows = reader.integer(integer, "rows"), columns = reader.integer(integer, "columns"),
                  entries = reader.integer(integer, "entries");
  constexpr long long most = std::numeric_limits<int>::max();
  if (rows < 1 || columns < 1 || rows > most || columns > most)
    at.fail("a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) +
            ", expected dimensions from 1 to " + std::to_string(most));
  if (entries < 0)
    at.fail("the matrix is dense (it has " + std::to_string(entries) + " entries), expected AIJ");
  reader.expect_room(rows, size, "rows");
  reader.expect_room(entries, size + 8, "entries");
  check_rows(at, static_cast<int>(rows), static_cast<int>(columns), entries);
  std::vector<long long> in_row;
  long long sum = 0;
  for (long long r = 0; r < rows; ++r) {
    const Location here = reader.at();
    in_row.push_back(reader.integer(integer, "how many entries a row has"));
    if (in_row.back() < 0 || in_row.back() > entries - sum)
      here.fail("row " + std::to_string(r) + " has " + std::to_string(in_row.back()) +
                " entries, expected 0 to the " + std::to_string(entries - sum) + " that are left");
    sum += in_row.back();
  }
  if (sum != entries)
    at.fail("the rows have " + std::to_string(sum) + " entries, expected " + std::to_string(entries));
  reader.expect_room(entries, size + 8, "entries");
  BinaryReader values(source, bytes, std::endian::big,
                      reader.position() + static_cast<std::size_t>(entries) * size);
  MatrixBuilder builder(source, static_cast<int>(rows), static_cast<int>(columns), Symmetry::general);
  builder.reserve(static_cast<std::size_t>(entries));
  for (long long r = 0; r < rows; ++r)
    for (long long i = 0; i < in_row[static_cast<std::size_t>(r)]; ++i) {
      const long line = reader.at().line;
      const long long column = reader.integer(integer, "a column");
      builder.add(line, r + 1, column < most ? column + 1 : column,
                  values.finite(NumberType::f64, "an entry"));
    }
  if (values.bytes_left() > 0)
    values.at().fail(std::to_string(values.bytes_left()) +
                     " bytes behind the matrix, expected the end of the file");
  return std::move(builder).build(duplicates);
}

}  // namespace springstab
