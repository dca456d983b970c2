#include "solvers/io/vtk.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solvers/io/binary_reader.h"
#include "solvers/io/vtk_cells.h"

namespace springstab {
namespace {

/// The types of numbers that a binary file may have, as this machine would write them.
NumberType vtk_number_type(const Location& at, std::string_view name) {
  using enum NumberType;
  constexpr struct {
    std::string_view name;
    NumberType type;
  } types[] = {{"CHAR", i8},           {"SIGNED_CHAR", i8},     {"UNSIGNED_CHAR", u8},
               {"SHORT", i16},         {"UNSIGNED_SHORT", u16}, {"INT", i32},
               {"UNSIGNED_INT", u32},  {"VTKIDTYPE", i32},      {"LONG", i64},
               {"UNSIGNED_LONG", u64}, {"VTKTYPEINT64", i64},   {"VTKTYPEUINT64", u64},
               {"FLOAT", f32},         {"DOUBLE", f64}};
  for (const auto& known : types)
    if (known.name == name) return known.type;
  at.fail("the type of numbers " + springstab::quoted(lowercase(name)) +
          ", expected one such as int, vtktypeint64, float or double");
}

class VtkReader {
 public:
  VtkReader(const std::string& source, std::string_view text)
      : source_(source), text_(text), lines_(source, text), builder_(source) {}

  AnyMesh read() {
    header();
    while (next_word()) {
      const std::string keyword = uppercase(word_);
      if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;  // to the end
      section(keyword);
    }
    if (types_.size() != cells_.size()) lines_.at().fail("the file ends, expected CELL_TYPES");
    for (std::size_t i = 0; i < cells_.size(); ++i)
      add_vtk_cell(builder_, types_[i],
                   {corners_.data() + cells_[i].first, static_cast<std::size_t>(cells_[i].count)},
                   cells_[i].at);
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
    binary_ = encoding == "BINARY";
    if (!binary_ && encoding != "ASCII")
      lines_.at().fail("the file is " + quoted(lines_.line()) + ", expected ASCII or BINARY");
    if (binary_) lines_.go_to(lines_.position());
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

  /// What `read` finds in a binary file behind the line of the last keyword.
  template <class Read>
  auto behind_line(const Read& read) {
    if (next_in_line_ < words_.size())
      at_.fail(quoted(words_[next_in_line_]) + " stands here, expected the end of the line");
    BinaryReader bytes(source_, text_, std::endian::big, lines_.position());
    at_ = bytes.at();
    const auto value = read(bytes);
    lines_.go_to(bytes.position());
    return value;
  }

  long long integer(const std::string& what) {
    if (binary_) return behind_line([&](BinaryReader& bytes) { return bytes.integer(type_, what); });
    word(what);
    return at_.integer(word_);
  }
  double real(const std::string& what) {
    if (binary_) return behind_line([&](BinaryReader& bytes) { return bytes.finite(type_, what); });
    word(what);
    return at_.real(word_);
  }
  /// Always text.
  long long count(const std::string& things) {
    word("a number of " + things);
    return count_of(at_, word_, things);
  }
  /// How many corners or cells follow, as numbers like theirs.
  long long count_among_numbers(const std::string& things) {
    if (!binary_) return count(things);
    const long long count = integer("a number of " + things);
    if (count < 0) at_.fail(std::to_string(count) + " " + things + ", expected 0 or more");
    return count;
  }

  /// float, vtktypeint64 and the like: no number.
  void type_of_numbers(bool real) {
    const std::string name = word("a type of numbers");
    if (name[0] < 'A' || name[0] > 'Z') at_.fail(quoted(word_) + " stands here, expected a type of numbers");
    if (!binary_) return;
    type_ = vtk_number_type(at_, name);
    if (is_real(type_) && !real) at_.fail(quoted(word_) + " stands here, expected a type of integers");
  }

  void points() {
    const long long points = count("points");
    type_of_numbers(true);
    for (long long i = 0; i < points; ++i) {
      const double x = real("a coordinate"), y = real("a coordinate"), z = real("a coordinate");
      builder_.add_vertex(next_point_++, {x, y, z}, at_);
    }
  }

  void cells() {
    const long long first = count("cells"), second = count("numbers");
    if (binary_ ? text_.substr(lines_.position()).starts_with("OFFSETS") : next_word()) {
      if (binary_ || uppercase(word_) == "OFFSETS") return cells_by_offsets(first, second);
      --next_in_line_;  // it was the first cell's
    }
    type_ = NumberType::i32;
    long long numbers = 0;
    for (long long i = 0; i < first; ++i) {
      Cell cell{corners_.size(), count_among_numbers("corners"), at_};
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
    if (binary_) word("OFFSETS");
    type_of_numbers(false);
    std::vector<long long> offset;
    for (long long i = 0; i < offsets; ++i) {
      offset.push_back(integer("an offset"));
      if (offset.back() < (i > 0 ? offset[offset.size() - 2] : 0) || (i == 0 && offset.back() != 0))
        at_.fail("the offset '" + std::to_string(offset.back()) +
                 "' is out of order, expected them to ascend from 0");
    }
    if (word("CONNECTIVITY") != "CONNECTIVITY")
      at_.fail(quoted(word_) + " stands here, expected CONNECTIVITY");
    type_of_numbers(false);
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
    type_ = NumberType::i32;
    for (const Cell& cell : cells_) {
      const long long type = integer("a type of a cell");
      check_vtk_cell(type, cell.count, at_, cell.at);
      types_.push_back(type);
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
      const std::string type = word("a type of numbers");
      const bool strings = type == "STRING";
      if (binary_) {
        skip_array(type, values);
        continue;
      }
      for (long long v = 0; v < values; ++v) {
        if (!strings) {
          word("a value");
        } else if (!lines_.next()) {
          lines_.at().fail("the file ends, expected a string");
        }
      }
    }
  }

  /// Of a binary file. Bits stand eight in a byte. A string has its length before it, in as many bytes as the
  /// first two bits say (0: 8, 1: 4, 2: 2, 3: 1) and without these bits.
  void skip_array(const std::string& type, long long values) {
    behind_line([&](BinaryReader& bytes) {
      if (type != "STRING") {
        const auto bits =
            static_cast<std::size_t>(type == "BIT" ? 1 : 8 * bytes_of(vtk_number_type(at_, type)));
        bytes.expect_room(bits == 1 ? values / 8 : values, std::max<std::size_t>(bits / 8, 1), "values");
        return bytes.take((static_cast<std::size_t>(values) * bits + 7) / 8, "values").size();
      }
      for (long long v = 0; v < values; ++v) {
        const auto first = bytes.next<std::uint8_t>("a string");
        std::uint64_t length = first & 0x3FU;
        for (int more = (8 >> (first >> 6)) - 1; more > 0; --more)
          length = (length << 8) + bytes.next<std::uint8_t>("a string");
        bytes.take(length, "a string");
      }
      return std::size_t{0};
    });
  }

  const std::string& source_;
  std::string_view text_;
  LineReader lines_;
  MeshBuilder builder_;
  std::vector<std::string_view> words_;
  std::size_t next_in_line_ = 0;
  std::string_view word_;
  Location at_;
  long long next_point_ = 0;
  bool poly_data_ = false, binary_ = false;
  NumberType type_ = NumberType::i32;  // of what follows, in binary files
  std::vector<Cell> cells_;
  std::vector<long long> corners_, types_;  // all corners; a type for each cell
};

}  // namespace

bool is_binary_vtk(std::string_view beginning) {
  LineReader lines({}, beginning);
  return beginning.starts_with("# vtk DataFile") && lines.next() && lines.next() && lines.next() &&
         uppercase(trimmed(lines.line())) == "BINARY";
}

AnyMesh parse_vtk(const std::string& source, std::string_view text) { return VtkReader(source, text).read(); }

}  // namespace springstab
