#include "solvers/io/vtk.h"

#include <algorithm>
#include <array>
#include <vector>

#include "solvers/io/tet_builder.h"

namespace springstab {
namespace {

/// Points, lines and surfaces, of first and second order: what a solid does not need.
constexpr auto skipped_vtk_types =
    std::to_array<long long>({1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 30, 34});
constexpr long long tetrahedron = 10;

std::string upper_case(std::string_view word) {
  std::string upper(word);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return upper;
}

class VtkReader {
 public:
  VtkReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

  TetMesh read() {
    header();
    while (next_word()) {
      const std::string keyword = upper_case(word_);
      if (keyword == "POINTS") {
        points();
      } else if (keyword == "CELLS") {
        cells();
      } else if (keyword == "CELL_TYPES") {
        types();
      } else if (keyword == "METADATA") {
        skip_to_blank_line();
      } else if (keyword == "FIELD") {
        skip_fields();
      } else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
        break;  // to the end
      } else {
        at_.fail("unknown keyword " + quoted(word_) + ", expected POINTS, CELLS or CELL_TYPES");
      }
    }
    add_tets();
    return builder_.finish("cells of type 10");
  }

 private:
  struct Cell {
    std::array<long long, 4> corners;  // the first ones
    long long count;                   // of all corners
    Location at;
  };

  void header() {
    const auto next_line = [&](const std::string& expected) {
      if (!lines_.next()) lines_.at().fail("the file ends, expected " + expected);
      return trimmed(lines_.line());
    };
    constexpr const char* first = "'# vtk DataFile Version' and a number";
    if (!next_line(first).starts_with("# vtk DataFile Version"))
      lines_.at().fail(quoted(lines_.line()) + " begins the file, expected " + first);
    next_line("a title");
    if (upper_case(next_line("ASCII")) != "ASCII")
      lines_.at().fail("the file is " + quoted(lines_.line()) + ", expected ASCII");
    if (word("DATASET") != "DATASET") at_.fail(quoted(word_) + " stands here, expected DATASET");
    if (word("UNSTRUCTURED_GRID") != "UNSTRUCTURED_GRID")
      at_.fail("the data are " + quoted(word_) + ", expected UNSTRUCTURED_GRID");
  }

  /// Steps to the next word, wherever the lines end; false at the end of the file.
  bool next_word() {
    while (next_in_line_ == words_.size()) {
      words_.clear();
      next_in_line_ = 0;
      if (!lines_.next()) return false;
      append_words(lines_.line(), words_);
    }
    word_ = words_[next_in_line_++];
    at_ = lines_.at();
    return true;
  }

  /// The next word, in capitals.
  std::string word(const std::string& expected) {
    if (!next_word()) lines_.at().fail("the file ends, expected " + expected);
    return upper_case(word_);
  }

  long long integer(const std::string& what) {
    word(what);
    return at_.integer(word_);
  }
  long long count(const std::string& things) {
    word("a number of " + things);
    return count_of(at_, word_, things);
  }
  double real(const std::string& what) {
    word(what);
    return at_.real(word_);
  }

  void points() {
    const long long points = count("points");
    word("a type of numbers");
    for (long long i = 0; i < points; ++i) {
      const double x = real("a coordinate"), y = real("a coordinate"), z = real("a coordinate");
      builder_.add_vertex(next_point_++, {x, y, z}, at_);
    }
  }

  void cells() {
    if (!cells_.empty()) at_.fail("CELLS stands here a second time, expected it once");
    const long long first = count("cells"), second = count("numbers");
    if (next_word()) {
      if (upper_case(word_) == "OFFSETS") return cells_by_offsets(first, second);
      --next_in_line_;  // it was the first cell's
    }
    long long numbers = 0;
    for (long long i = 0; i < first; ++i) {
      Cell cell{{}, count("corners"), at_};
      read_corners(cell);
      numbers += 1 + cell.count;
      cells_.push_back(cell);
    }
    check_count(at_, "numbers of cells", numbers, second);
  }

  void read_corners(Cell& cell) {
    for (long long c = 0; c < cell.count; ++c) {
      const long long corner = integer("a corner");
      if (c < 4) cell.corners[static_cast<std::size_t>(c)] = corner;
    }
  }

  /// As version 5 has them: one offset more than cells, then all corners.
  void cells_by_offsets(long long offsets, long long corners) {
    word("a type of numbers");
    std::vector<long long> offset;
    for (long long i = 0; i < offsets; ++i) {
      offset.push_back(integer("an offset"));
      if (offset.back() < (i > 0 ? offset[offset.size() - 2] : 0) || (i == 0 && offset.back() != 0))
        at_.fail("the offset " + quoted(word_) + " is out of order, expected them to ascend from 0");
    }
    if (word("CONNECTIVITY") != "CONNECTIVITY")
      at_.fail(quoted(word_) + " stands here, expected CONNECTIVITY");
    word("a type of numbers");
    check_count(at_, "corners by the offsets", offset.empty() ? 0 : offset.back(), corners);
    for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
      Cell cell{{}, offset[i + 1] - offset[i], at_};
      read_corners(cell);
      cell.at = at_;
      cells_.push_back(cell);
    }
  }

  void types() {
    const long long types = count("types");
    check_count(at_, "types of cells", types, static_cast<long long>(cells_.size()));
    for (const Cell& cell : cells_) {
      const long long type = integer("a type of a cell");
      if (type != tetrahedron && std::ranges::find(skipped_vtk_types, type) == skipped_vtk_types.end())
        at_.fail("a cell of type " + std::to_string(type) + ", expected tetrahedra (type 10)");
      if (type == tetrahedron && cell.count != 4)
        cell.at.fail("a tetrahedron of " + std::to_string(cell.count) + " corners, expected four");
      is_tet_.push_back(type == tetrahedron);
    }
  }

  void add_tets() {
    if (is_tet_.size() != cells_.size()) lines_.at().fail("the file ends, expected CELL_TYPES");
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (is_tet_[i]) builder_.add_tet(cells_[i].corners, cells_[i].at);
  }

  void skip_to_blank_line() {
    next_in_line_ = words_.size();
    while (lines_.next() && !trimmed(lines_.line()).empty()) {
    }
  }

  /// name count; of each array name components tuples type, and its values.
  void skip_fields() {
    word("a name");
    const long long arrays = count("arrays");
    for (long long a = 0; a < arrays; ++a) {
      word("a name");
      const long long components = count("components"), values = components * count("tuples");
      word("a type of numbers");
      for (long long v = 0; v < values; ++v) word("a value");
    }
  }

  LineReader lines_;
  TetBuilder builder_;
  std::vector<std::string_view> words_;
  std::size_t next_in_line_ = 0;
  std::string_view word_;
  Location at_;
  long long next_point_ = 0;
  std::vector<Cell> cells_;
  std::vector<bool> is_tet_;
};

}  // namespace

TetMesh parse_vtk(const std::string& source, std::string_view text) { return VtkReader(source, text).read(); }

}  // namespace springstab
