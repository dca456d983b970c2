#include "solvers/io/harwell_boeing.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/io/fortran_format.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

/// Calls use(k, field, text) for `count` fields, trimmed; a blank one, which Fortran would read as 0, is an
/// error.
template <class Use>
void read_fields(LineReader& lines, const FortranFormat& format, long long count, const std::string& what,
                 const Use& use) {
  std::string_view line;
  std::size_t end = 0;  // of the last field
  long long taken = 0;  // lines
  const auto take_lines = [&](long long wanted, long long numbers) {
    for (; taken < wanted; ++taken) {
      if (!trimmed(line.substr(std::min(end, line.size()))).empty())
        lines.at().fail("text behind the last field, expected only what fits " + format.text());
      if (!lines.next())
        lines.at().fail("the file ends after " + std::to_string(numbers) + " " + what + ", expected " +
                        std::to_string(count));
      line = lines.line();
    }
  };
  for (long long k = 0; k < count; ++k) {
    const FortranField field = format.field(k);
    take_lines(field.line + 1, k);
    const auto begin = static_cast<std::size_t>(field.column);
    end = begin + static_cast<std::size_t>(field.width);
    const std::string_view text = trimmed(line.substr(std::min(begin, line.size()), end - begin));
    if (text.empty())
      lines.at().fail("a blank field, expected number " + std::to_string(k + 1) + " of the " +
                      std::to_string(count) + " " + what + " in the format " + format.text());
    use(k, field, text);
  }
  if (!trimmed(line.substr(std::min(end, line.size()))).empty())
    lines.at().fail("text behind the last of the " + std::to_string(count) + " " + what +
                    ", expected a blank");
  line = {};
  take_lines(format.lines_for(count), count);
}

/// The symmetry that a type such as RSA names; throws for what is not a real, square, assembled matrix.
Symmetry parse_type(std::string_view word, const Location& at) {
  const std::string type = uppercase(word);
  const auto is = [&type](std::size_t i, std::string_view letters) {
    return letters.find(type[i]) != letters.npos;
  };
  const std::string problem = type.size() != 3 ? "unknown"
                              : is(0, "C")     ? "complex"
                              : is(0, "P")     ? "a pattern without values"
                              : is(1, "H")     ? "hermitian, hence complex"
                              : is(1, "R")     ? "rectangular"
                              : is(2, "E")     ? "elemental, that is, not assembled"
                              : is(0, "RI") && is(1, "SUZ") && is(2, "A") ? ""
                                                                          : "unknown";
  if (!problem.empty())
    at.fail("the matrix type " + quoted(type) + " is " + problem + ", expected RSA, RUA or RZA");
  return is(1, "S") ? Symmetry::symmetric : is(1, "U") ? Symmetry::general : Symmetry::skew_symmetric;
}

struct Header {
  int n = 0;
  long long entries = 0, right_hand_side_lines = 0;
  Symmetry symmetry = Symmetry::general;
  FortranFormat pointers, indices, values;
};

Header parse_header(LineReader& lines, std::size_t bytes) {
  Words words;
  const auto next = [&](const std::string& expected) {
    if (!lines.next()) lines.at().fail("the file ends in its header, expected " + expected);
    words.clear();
    append_words(lines.line(), words);
  };
  // Whatever is counted takes a byte at least: this bounds sums and allocations.
  const auto count = [&](std::size_t i, const std::string& what) {
    const long long number = lines.at().integer(words[i]);
    if (number < 0 || static_cast<unsigned long long>(number) > bytes)
      lines.at().fail(std::to_string(number) + " " + what + ", expected at most what a file of " +
                      std::to_string(bytes) + " bytes can hold");
    return number;
  };

  Header header;
  next("a title");
  next("the numbers of lines");
  const Location counts_at = lines.at();
  if (words.size() != 4 && words.size() != 5)
    counts_at.fail(
        std::to_string(words.size()) +
        " numbers of lines, expected those of all data, pointers, indices, values, and right-hand sides");
  std::array<long long, 5> line_counts{};
  for (std::size_t i = 0; i < words.size(); ++i) line_counts[i] = count(i, "lines");
  const auto [total, pointer_lines, index_lines, value_lines, right_hand_side_lines] = line_counts;
  header.right_hand_side_lines = right_hand_side_lines;

  next("type and size of the matrix");
  header.symmetry = parse_type(words.empty() ? "" : words[0], lines.at());
  if (words.size() != 4 && words.size() != 5)
    lines.at().fail("a size of " + std::to_string(words.size() - 1) +
                    " numbers, expected rows, columns and entries");
  const long long rows = count(1, "rows"), columns = count(2, "columns");
  header.entries = count(3, "entries");
  if (rows != columns || rows < 1 || rows >= std::numeric_limits<int>::max())
    lines.at().fail("a matrix of " + std::to_string(rows) + " by " + std::to_string(columns) +
                    ", expected a square one of 1 to 2^31 - 2 rows");
  header.n = static_cast<int>(rows);

  next("the formats");
  std::string_view formats = lines.line();
  header.pointers = FortranFormat::take(formats, "I", lines.at());
  header.indices = FortranFormat::take(formats, "I", lines.at());
  header.values = FortranFormat::take(formats, "IFEDG", lines.at());

  const auto check = [&counts_at](long long number, long long expected, const std::string& what) {
    if (number != expected)
      counts_at.fail(std::to_string(number) + " lines of " + what + ", expected " + std::to_string(expected));
  };
  check(pointer_lines, header.pointers.lines_for(columns + 1), "column pointers by their number and format");
  check(index_lines, header.indices.lines_for(header.entries), "row indices by their number and format");
  check(value_lines, header.values.lines_for(header.entries), "values by their number and format");
  check(total, pointer_lines + index_lines + value_lines + right_hand_side_lines, "data in total");
  if (right_hand_side_lines > 0) next("the kind of the right-hand sides");
  return header;
}

}  // namespace

bool looks_like_harwell_boeing(std::string_view text) {
  LineReader lines({}, text);
  for (int i = 0; i < 3; ++i)
    if (!lines.next()) return false;
  Words words;
  append_words(lines.line(), words);
  const auto letter = [](char c) { return c >= 'A' && c <= 'Z'; };
  if (words.empty() || words[0].size() != 3 || !std::ranges::all_of(uppercase(words[0]), letter))
    return false;
  return lines.next() && trimmed(lines.line()).starts_with('(');
}

Eigen::SparseMatrix<double> parse_harwell_boeing(std::string_view source, std::string_view text,
                                                 Duplicates duplicates) {
  LineReader lines(source, text);
  const Header header = parse_header(lines, text.size());
  // The file counts from 1: column c holds the entries pointers[c - 1] to pointers[c] - 1.
  std::vector<long long> pointers;
  pointers.reserve(static_cast<std::size_t>(header.n) + 1);
  read_fields(lines, header.pointers, header.n + 1LL, "column pointers",
              [&](long long k, const FortranField&, std::string_view field) {
                const long long pointer = lines.at().integer(field);
                const long long least = k == header.n ? header.entries + 1 : k == 0 ? 1 : pointers.back();
                const long long most = k == 0 ? 1 : header.entries + 1;
                if (pointer < least || pointer > most)
                  lines.at().fail("column pointer " + std::to_string(k + 1) + " is " +
                                  std::to_string(pointer) + ", expected " + std::to_string(least) +
                                  (least < most ? " to " + std::to_string(most) : ""));
                pointers.push_back(pointer);
              });

  std::vector<long long> rows;
  rows.reserve(static_cast<std::size_t>(header.entries));
  const long index_line = lines.at().line + 1;
  read_fields(lines, header.indices, header.entries, "row indices",
              [&](long long, const FortranField&, std::string_view field) {
                rows.push_back(lines.at().integer(field));
              });

  MatrixBuilder builder(std::string(source), header.n, header.n, header.symmetry);
  builder.reserve(rows.size());
  std::size_t column = 1;
  const auto add = [&](long long k, const FortranField& field, std::string_view number) {
    while (pointers[column] <= k + 1) ++column;
    builder.add(index_line + static_cast<long>(header.indices.field(k).line),
                rows[static_cast<std::size_t>(k)], static_cast<long long>(column),
                fortran_number(number, field, lines.at()));
  };
  read_fields(lines, header.values, header.entries, "values", add);

  for (long long k = 0; k < header.right_hand_side_lines; ++k)
    if (!lines.next())
      lines.at().fail("the file ends in its right-hand sides, expected " +
                      std::to_string(header.right_hand_side_lines) + " lines of them");
  while (lines.next())
    if (!trimmed(lines.line()).empty())
      lines.at().fail(
          "text after the matrix, expected the end of the file by the numbers of lines on line 2");
  return std::move(builder).build(duplicates);
}

}  // namespace springstab
