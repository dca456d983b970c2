#include "solvers/io/matrix_market.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/io/text_file.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view banner = "%%matrixmarket";

/// What the banner line says: "%%MatrixMarket matrix FORMAT FIELD SYMMETRY".
struct Kind {
  bool coordinate = true;
  Symmetry symmetry = Symmetry::general;
};

Kind parse_banner(std::string_view line, const Location& at) {
  const std::string lower = lowercase(line);
  Words words;
  append_words(lower, words);
  const auto comment = [](std::string_view word) { return word.starts_with('%') && word != banner; };
  words.erase(std::ranges::find_if(words, comment), words.end());
  if (words.empty() || words[0] != banner)
    at.fail("no Matrix Market banner, expected '%%MatrixMarket matrix coordinate real general' or the like");
  if (words.size() != 5 || words[1] != "matrix")
    at.fail("the banner is malformed, expected '%%MatrixMarket matrix FORMAT FIELD SYMMETRY'");
  Kind kind;
  if (words[2] == "array")
    kind.coordinate = false;
  else if (words[2] != "coordinate")
    at.fail("unknown format " + quoted(words[2]) + ", expected coordinate or array");
  if (words[3] == "complex") at.fail("a complex matrix, expected a real or integer one");
  if (words[3] == "pattern") at.fail("a pattern without values, expected a real or integer matrix");
  constexpr auto fields =
      std::to_array<std::string_view>({"real", "double", "float", "integer", "unsigned-integer"});
  if (!is_among(fields, words[3]))
    at.fail("unknown field " + quoted(words[3]) + ", expected real or integer");
  if (words[4] == "hermitian")
    at.fail("a hermitian, hence complex matrix, expected general, symmetric or skew-symmetric");
  if (words[4] == "symmetric")
    kind.symmetry = Symmetry::symmetric;
  else if (words[4] == "skew-symmetric")
    kind.symmetry = Symmetry::skew_symmetric;
  else if (words[4] != "general")
    at.fail("unknown symmetry " + quoted(words[4]) + ", expected general, symmetric or skew-symmetric");
  return kind;
}

/// Steps to the first line that is not blank, trimmed.
std::string_view first_line(LineReader& lines) {
  std::string_view line;
  while (line.empty() && lines.next()) line = trimmed(lines.line());
  return line;
}

/// Steps to the next line with data and splits it; false at the end of the text.
bool next_data(LineReader& lines, Words& words) {
  do {
    if (!lines.next()) return false;
    words.clear();
    append_words(lines.line(), words, '%');
  } while (words.empty());
  return true;
}

struct Size {
  int rows = 0, columns = 0;
  long long entries = 0;  // lines that follow
  long line = 0;
};

Size parse_size(const Kind& kind, const Words& words, const Location& at) {
  const std::size_t count = kind.coordinate ? 3 : 2;
  if (words.size() != count)
    at.fail("a size line of " + std::to_string(words.size()) + " words, expected " +
            (kind.coordinate ? "rows, columns and number of entries" : "rows and columns"));
  const long long rows = at.integer(words[0]), columns = at.integer(words[1]);
  constexpr long long largest = std::numeric_limits<int>::max();
  if (rows < 1 || columns < 1 || rows > largest || columns > largest)
    at.fail("a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) +
            ", expected dimensions from 1 to " + std::to_string(largest));
  if (kind.symmetry != Symmetry::general && rows != columns)
    at.fail("a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) +
            ", expected a square one since the banner calls it (skew-)symmetric");
  Size size{static_cast<int>(rows), static_cast<int>(columns), 0, at.line};
  if (kind.coordinate)
    size.entries = at.integer(words[2]);
  else if (kind.symmetry == Symmetry::general)
    size.entries = rows * columns;
  else
    size.entries = kind.symmetry == Symmetry::symmetric ? rows * (rows + 1) / 2 : rows * (rows - 1) / 2;
  return size;
}

/// A size line of a few bytes must not make us allocate gigabytes. An entry takes at least three digits, two
/// blanks and a line feed; in an array, a digit and a line feed.
void check_backed(const Kind& kind, const Size& size, std::size_t bytes_left, const Location& at) {
  const std::size_t bytes_per_entry = kind.coordinate ? 6 : 2;
  const auto most = static_cast<long long>((bytes_left + 1) / bytes_per_entry);  // the last LF may be missing
  if (size.entries < 0 || size.entries > most)
    at.fail("the size line announces " + std::to_string(size.entries) + " entries, expected at most the " +
            std::to_string(most) + " that the rest of the file has room for");
  check_rows(at, size.rows, size.columns, size.entries);
}

struct Announced {
  Kind kind;
  Size size;
};

Announced parse_announced(LineReader& lines) {
  first_line(lines);
  const Kind kind = parse_banner(lines.line(), lines.at());
  Words words;
  if (!next_data(lines, words)) lines.at().fail("the file ends here, expected a size line");
  const Size size = parse_size(kind, words, lines.at());
  check_backed(kind, size, lines.bytes_left(), lines.at());
  return {kind, size};
}

void add_entries(LineReader& lines, const Kind& kind, const Size& size, MatrixBuilder& builder) {
  // An array lists column after column, each from this row down.
  const auto first_row = [&](int column) {
    return kind.symmetry == Symmetry::general     ? 1
           : kind.symmetry == Symmetry::symmetric ? column
                                                  : column + 1;
  };
  int column = 1, row = first_row(column);
  const std::size_t words_per_entry = kind.coordinate ? 3 : 1;
  long long entries = 0;
  Words words;
  for (; next_data(lines, words); ++entries) {
    const Location at = lines.at();
    if (entries == size.entries)
      at.fail("one more entry than expected from the size on line " + std::to_string(size.line) +
              ", which gives " + std::to_string(size.entries));
    if (words.size() != words_per_entry)
      at.fail("an entry of " + std::to_string(words.size()) + " words, expected " +
              (kind.coordinate ? "row, column and value" : "one value"));
    if (kind.coordinate) {
      builder.add(at.line, at.integer(words[0]), at.integer(words[1]), at.fortran_real(words[2]));
    } else {
      if (const double entry = at.fortran_real(words[0]); entry != 0)
        builder.add(at.line, row, column, entry);
      if (++row > size.rows) row = first_row(++column);
    }
  }
  if (entries < size.entries)
    lines.at().fail("the file ends after " + std::to_string(entries) + " entries, expected " +
                    std::to_string(size.entries) + " from the size on line " + std::to_string(size.line));
}

}  // namespace

bool has_matrix_market_banner(std::string_view text) {
  LineReader lines({}, text);
  return lowercase(first_line(lines).substr(0, banner.size())) == banner;
}

Eigen::SparseMatrix<double> parse_matrix_market(std::string_view source, std::string_view text,
                                                Duplicates duplicates) {
  LineReader lines(source, text);
  const auto [kind, size] = parse_announced(lines);
  MatrixBuilder builder(std::string(source), size.rows, size.columns, kind.symmetry);
  if (kind.coordinate) builder.reserve(static_cast<std::size_t>(size.entries));
  add_entries(lines, kind, size, builder);
  return std::move(builder).build(duplicates);
}

MatrixRows parse_matrix_market_rows(std::string_view source, std::string_view text,
                                    const std::function<IndexRange(int rows)>& rows_of,
                                    Duplicates duplicates) {
  LineReader lines(source, text);
  const auto [kind, size] = parse_announced(lines);
  MatrixBuilder builder(std::string(source), size.rows, size.columns, kind.symmetry, rows_of(size.rows));
  add_entries(lines, kind, size, builder);
  return std::move(builder).build_rows(duplicates);
}

}  // namespace springstab
