#include "solvers/io/vtk.h"

#include <algorithm>
#include <array>
#include <vector>

namespace springstab {
namespace {

/// Types of cells: nothing, points and lines, of any order; and curved surfaces, which have points within
/// their edges.
constexpr auto vtk_skipped = std::to_array<long long>({0, 1, 2, 3, 4, 21, 35, 68, 75});
constexpr auto vtk_curved_surfaces = std::to_array<long long>({22, 23, 28, 30, 34, 36, 69, 70, 76, 77});
/// The types that are read.
enum VtkCell { vtk_triangle = 5, vtk_strip, vtk_polygon, vtk_pixel, vtk_quadrangle, vtk_tetrahedron };

class VtkReader {
 public:
  VtkReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

  AnyMesh read() {
    header();
    while (next_word()) {
      const std::string keyword = uppercase(word_);
      if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;  // to the end
      section(keyword);
    }
    if (types_.size() != cells_.size()) lines_.at().fail("the file ends, expected CELL_TYPES");
    for (std::size_t i = 0; i < cells_.size(); ++i) add(cells_[i], types_[i]);
    return std::move(builder_).finish("cells of types 5 to 10");
  }

 private:
  struct Cell {
    std::size_t first;  // of its corners in corners_
    long long count;
    Location at;
  };

  void section(const std::string& keyword) {
    if (keyword == "POINTS") {
      points();
    } else if (!poly_data_ && keyword == "CELLS") {
      if (!cells_.empty()) at_.fail("CELLS stands here a second time, expected it once");
      cells();
    } else if (!poly_data_ && keyword == "CELL_TYPES") {
      types();
    } else if (poly_data_ && (keyword == "VERTICES" || keyword == "LINES")) {
      cells();
      types_.resize(cells_.size(), 0);
    } else if (poly_data_ && keyword == "POLYGONS") {
      cells();
      types_.resize(cells_.size(), vtk_polygon);
    } else if (poly_data_ && keyword == "TRIANGLE_STRIPS") {
      cells();
      types_.resize(cells_.size(), vtk_strip);
    } else if (keyword == "METADATA") {
      skip_to_blank_line();
    } else if (keyword == "FIELD") {
      skip_fields();
    } else {
      at_.fail("unknown keyword " + quoted(word_) + ", expected POINTS" +
               (poly_data_ ? ", POLYGONS, TRIANGLE_STRIPS, LINES or VERTICES" : ", CELLS or CELL_TYPES"));
    }
  }

  void header() {
    const auto next_line = [&](const std::string& expected) {
      if (!lines_.next()) lines_.at().fail("the file ends, expected " + expected);
      return trimmed(lines_.line());
    };
    constexpr const char* first = "'# vtk DataFile Version' and a number";
    if (!next_line(first).starts_with("# vtk DataFile Version"))
      lines_.at().fail(quoted(lines_.line()) + " begins the file, expected " + first);
    next_line("a title");
    const std::string encoding = uppercase(next_line("ASCII"));
    if (encoding == "BINARY") lines_.at().fail(binary_file_message("# vtk DataFile"));
    if (encoding != "ASCII") lines_.at().fail("the file is " + quoted(lines_.line()) + ", expected ASCII");
    while (word("DATASET") == "FIELD") skip_fields();
    if (uppercase(word_) != "DATASET") at_.fail(quoted(word_) + " stands here, expected DATASET");
    const std::string data = word("UNSTRUCTURED_GRID");
    poly_data_ = data == "POLYDATA";
    if (!poly_data_ && data != "UNSTRUCTURED_GRID")
      at_.fail("the data are " + quoted(word_) + ", expected UNSTRUCTURED_GRID or POLYDATA");
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
    return uppercase(word_);
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

  /// float, vtktypeint64 and the like: no number.
  void type_of_numbers() {
    const std::string name = word("a type of numbers");
    if (name[0] < 'A' || name[0] > 'Z') at_.fail(quoted(word_) + " stands here, expected a type of numbers");
  }

  void points() {
    const long long points = count("points");
    type_of_numbers();
    for (long long i = 0; i < points; ++i) {
      const double x = real("a coordinate"), y = real("a coordinate"), z = real("a coordinate");
      builder_.add_vertex(next_point_++, {x, y, z}, at_);
    }
  }

  void cells() {
    const long long first = count("cells"), second = count("numbers");
    if (next_word()) {
      if (uppercase(word_) == "OFFSETS") return cells_by_offsets(first, second);
      --next_in_line_;  // it was the first cell's
    }
    long long numbers = 0;
    for (long long i = 0; i < first; ++i) {
      Cell cell{corners_.size(), count("corners"), at_};
      read_corners(cell);
      numbers += 1 + cell.count;
      cells_.push_back(cell);
    }
    check_count(at_, "numbers of cells", numbers, second);
  }

  void read_corners(const Cell& cell) {
    for (long long c = 0; c < cell.count; ++c) corners_.push_back(integer("a corner"));
  }

  /// As version 5 has them: one offset more than cells, then all corners.
  void cells_by_offsets(long long offsets, long long corners) {
    type_of_numbers();
    std::vector<long long> offset;
    for (long long i = 0; i < offsets; ++i) {
      offset.push_back(integer("an offset"));
      if (offset.back() < (i > 0 ? offset[offset.size() - 2] : 0) || (i == 0 && offset.back() != 0))
        at_.fail("the offset " + quoted(word_) + " is out of order, expected them to ascend from 0");
    }
    if (word("CONNECTIVITY") != "CONNECTIVITY")
      at_.fail(quoted(word_) + " stands here, expected CONNECTIVITY");
    type_of_numbers();
    check_count(at_, "corners by the offsets", offset.empty() ? 0 : offset.back(), corners);
    for (std::size_t i = 0; i + 1 < offset.size(); ++i) {
      Cell cell{corners_.size(), offset[i + 1] - offset[i], at_};
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
      check_type(type, cell);
      types_.push_back(type);
    }
  }

  void check_type(long long type, const Cell& cell) const {
    const std::string kind = "a cell of type " + std::to_string(type);
    if (!is_among(vtk_skipped, type) && !is_among(vtk_curved_surfaces, type) &&
        (type < vtk_triangle || type > vtk_tetrahedron))
      at_.fail(kind + ", expected triangles to quadrangles or tetrahedra (types 5 to 10)");
    const int corners = type == vtk_triangle ? 3 : type >= vtk_pixel && type <= vtk_tetrahedron ? 4 : 0;
    if (corners > 0 && cell.count != corners)
      cell.at.fail(kind + " has " + std::to_string(cell.count) + " corners, expected " +
                   std::to_string(corners));
  }

  void add(const Cell& cell, long long type) {
    const std::span<const long long> c(corners_.data() + cell.first, static_cast<std::size_t>(cell.count));
    if (type == vtk_tetrahedron) {
      builder_.add_tet({c[0], c[1], c[2], c[3]}, cell.at);
    } else if (type == vtk_strip) {  // a triangle of each corner and the two before, every other one turned
      for (std::size_t k = 2; k < c.size(); ++k)
        builder_.add_face(std::array{c[k - 2 + k % 2], c[k - 1 - k % 2], c[k]}, cell.at);
    } else if (type == vtk_pixel) {  // by rows
      builder_.add_face(std::array{c[0], c[1], c[3], c[2]}, cell.at);
    } else if (type == vtk_triangle || type == vtk_polygon || type == vtk_quadrangle) {
      builder_.add_face(c, cell.at);
    } else if (is_among(vtk_curved_surfaces, type)) {
      builder_.add_unusable_face(cell.at, "a cell of type " + std::to_string(type) +
                                              ", which has points between its corners, expected flat ones "
                                              "(types 5 to 9)");
    }
  }

  void skip_to_blank_line() {
    next_in_line_ = words_.size();
    while (lines_.next() && !trimmed(lines_.line()).empty()) {
    }
  }

  /// name count; of each array name components tuples type, and its values: a line each if they are strings;
  /// it may have metadata behind it.
  void skip_fields() {
    word("a name");
    const long long arrays = count("arrays");
    for (long long a = 0; a < arrays; ++a) {
      if (word("a name") == "METADATA") {
        skip_to_blank_line();
        word("a name");
      }
      const long long components = count("components"), values = components * count("tuples");
      const bool strings = word("a type of numbers") == "STRING";
      for (long long v = 0; v < values; ++v) {
        if (!strings) {
          word("a value");
        } else if (!lines_.next()) {
          lines_.at().fail("the file ends, expected a string");
        }
      }
    }
  }

  LineReader lines_;
  MeshBuilder builder_;
  std::vector<std::string_view> words_;
  std::size_t next_in_line_ = 0;
  std::string_view word_;
  Location at_;
  long long next_point_ = 0;
  bool poly_data_ = false;
  std::vector<Cell> cells_;
  std::vector<long long> corners_, types_;  // all corners; a type for each cell
};

}  // namespace

AnyMesh parse_vtk(const std::string& source, std::string_view text) { return VtkReader(source, text).read(); }

}  // namespace springstab
