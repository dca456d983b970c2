#include "experiments/inputs/grid.h"

#include <charconv>

#include "experiments/command/words.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {

Grid parse_grid(const std::string& text, const std::string& source) {
  Grid grid;
  const char* end = text.data() + text.size();
  const auto rows = std::from_chars(text.data(), end, grid.rows);
  const bool cross = rows.ec == std::errc() && rows.ptr != end && (*rows.ptr == 'x' || *rows.ptr == 'X');
  const auto columns = cross ? std::from_chars(rows.ptr + 1, end, grid.columns) : rows;
  if (!cross || columns.ec != std::errc() || columns.ptr != end)
    throw InputError(source, 0, "'" + text + "' is not a size, expected ROWSxCOLUMNS like 32x32");
  check(grid, source);
  return grid;
}

Diagonals parse_diagonals(const std::string& word, const std::string& source, long line) {
  if (word == "uniform") return Diagonals::uniform;
  if (word == "alternating") return Diagonals::alternating;
  throw InputError(source, line,
                   "unknown diagonals " + springstab::quoted(word) + ", " +
                       expected_one_of(word, {"uniform", "alternating"}));
}

Faces grid_faces(const Grid& grid) {
  Faces faces;
  for (int i = 0; i + 1 < grid.rows; ++i)
    for (int j = 0; j + 1 < grid.columns; ++j) {
      const int p = i * grid.columns + j;
      faces.push_back({p, p + 1, p + grid.columns + 1, p + grid.columns});
    }
  return faces;
}

}  // namespace springstab
