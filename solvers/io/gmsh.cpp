#include "solvers/io/gmsh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "solvers/io/gmsh_binary.h"
#include "solvers/io/gmsh_elements.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

class GmshReader {
 public:
  GmshReader(const std::string& source, std::string_view text)
      : source_(source), text_(text), lines_(source, text), builder_(source) {}

  AnyMesh read() {
    while (next_words()) {
      const std::string section(words_.front());
      if (section.starts_with("//") || section.starts_with('#')) continue;
      if (!section.starts_with('$') || section.starts_with("$End") || section.starts_with("$END"))
        lines_.at().fail(quoted(section) + " begins no section, expected one such as $Nodes or $NOD");
      const std::string end = (section == "$NOD" || section == "$ELM" ? "$END" : "$End") + section.substr(1);
      if (section == "$MeshFormat") {
        format();
      } else if (section == "$Nodes" || section == "$ParametricNodes" || section == "$NOD") {
        nodes(section != "$Nodes");
      } else if (section == "$Elements" || section == "$ELM") {
        elements(section == "$ELM");
      } else {
        skip(end);
      }
      if (words_.empty() || words_.front() != end)
        lines_.at().fail("the section " + quoted(section) + " does not end here, expected " + quoted(end));
    }
    return std::move(builder_).finish("elements of type 2, 3 or 4");
  }

 private:
  enum class Version { up_to_2, v4_0, v4_1 };

  /// The next line that is not blank; false at the end, with no words.
  bool next_words() {
    words_.clear();
    while (words_.empty() && lines_.next()) append_words(lines_.line(), words_);
    return !words_.empty();
  }

  /// The same within a section: then its end mark is not one of its lines.
  bool next_line() { return next_words() && !words_.front().starts_with("$E"); }

  /// Steps to the end mark. What stands before it in a binary file need not be lines.
  void skip(const std::string& end) {
    if (order_) lines_.go_to(std::min(text_.find(end, lines_.position()), text_.size()));
    while (next_words() && words_.front() != end) {
    }
  }

  void format() {
    if (!next_line()) return;
    const Location at = lines_.at();
    if (words_.size() != 3)
      at.fail("a format of " + std::to_string(words_.size()) + " words, expected three");
    if (words_[0] == "4" || words_[0] == "4.0")
      version_ = Version::v4_0;
    else if (words_[0] == "4.1")
      version_ = Version::v4_1;
    else if (words_[0] != "2" && !words_[0].starts_with("2."))
      at.fail("the format is version " + quoted(words_[0]) +
              ", expected 1, 2, 4.0 or 4.1 (gmsh -format msh41 writes it)");
    if (words_[1] != "0") binary_format(at);
    next_words();
  }

  void binary_format(const Location& at) {
    if (version_ == Version::v4_0) at.fail(binary_file_message("$MeshFormat"));
    if (words_[1] != "1" || words_[2] != "8")
      at.fail(quoted(lines_.line()) +
              " is the format, expected a file type of 0 or 1 and numbers of 8 bytes");
    order_ = std::endian::little;
    from_binary([&](BinaryReader& bytes) {
      const Location one_at = bytes.at();
      const std::string_view one = bytes.take(4, "the number 1");
      if (number_of<std::int32_t>(one, std::endian::big) == 1)
        order_ = std::endian::big;
      else if (number_of<std::int32_t>(one, std::endian::little) != 1)
        one_at.fail("the number 1 is missing, expected it in the file's byte order");
    });
  }

  /// What `read` finds behind the lines that were read; then it is at the end mark.
  template <class Read>
  void from_binary(const Read& read) {
    BinaryReader bytes(source_, text_, *order_, lines_.position());
    read(bytes);
    lines_.go_to(bytes.position());
  }

  template <class Read, class Read2>
  void binary_section(const std::string& things, const Read& read, const Read2& read_2) {
    long long count = 0;
    if (version_ != Version::v4_1) {
      integers(1, "one number, of " + things);
      count = count_of(lines_.at(), words_[0], things);
    }
    from_binary([&](BinaryReader& bytes) {
      if (version_ == Version::v4_1) return read(bytes, builder_);
      read_2(bytes, count, builder_);
    });
    next_words();
  }

  /// A line of `size` counts or numbers of things.
  std::vector<long long> integers(std::size_t size, const std::string& expected) {
    if (!next_line()) lines_.at().fail("the section ends, expected " + expected);
    if (words_.size() != size)
      lines_.at().fail(quoted(lines_.line()) + " has " + std::to_string(words_.size()) + " words, expected " +
                       expected);
    std::vector<long long> numbers;
    for (const std::string_view word : words_) numbers.push_back(lines_.at().integer(word));
    return numbers;
  }

  /// Reads lines until the section's end, as many as its first line announces.
  template <class Line>
  void counted(const std::string& things, const Line& line) {
    integers(1, "one number, of " + things);
    const long long count = count_of(lines_.at(), words_[0], things);
    long long found = 0;
    for (; next_line(); ++found) line(lines_.at());
    check_count(lines_.at(), things, found, count);
  }

  /// Of version 4: numbers of blocks and of things, then the blocks, each with a line of four numbers.
  template <class Block>
  void blocks(const std::string& things, const Block& block) {
    const bool with_tags = version_ == Version::v4_1;
    integers(with_tags ? 4 : 2,
             with_tags ? "the numbers of blocks and of " + things + ", least and greatest tag (version 4.1)"
                       : "the numbers of blocks and of " + things + " (version 4.0)");
    const long long count = count_of(lines_.at(), words_[0], "blocks"),
                    announced = count_of(lines_.at(), words_[1], things);
    long long found = 0;
    for (long long b = 0; b < count; ++b) {
      const std::vector<long long> head =
          integers(4, "an entity's dimension and tag, a kind, and a number of " + things);
      const long long size = count_of(lines_.at(), words_[3], things);
      const long long dimension = head[with_tags ? 0 : 1];
      if (dimension < 0 || dimension > 3)
        lines_.at().fail("an entity of dimension " + std::to_string(dimension) + ", expected 0 to 3");
      block(dimension, head[2], size);
      found += size;
    }
    next_words();
    check_count(lines_.at(), things, found, announced);
  }

  /// The next of the lines of a block.
  Location block_line(const std::string& thing) {
    if (!next_line()) lines_.at().fail("the block ends, expected another " + thing);
    return lines_.at();
  }

  void nodes(bool with_parameters) {
    if (order_) return binary_section("nodes", read_gmsh_nodes, read_gmsh_2_nodes);
    if (version_ == Version::v4_0)
      return blocks("nodes", [&](long long dimension, long long parametric, long long n) {
        for (long long i = 0; i < n; ++i) numbered_node(block_line("node"), parametric != 0 ? dimension : 0);
      });
    if (version_ == Version::v4_1)
      return blocks("nodes", [&](long long dimension, long long parametric, long long n) {
        block_of_nodes(n, parametric != 0 ? dimension : 0);
      });
    // with the parameters, before them, the dimension and tag of the node's entity
    counted("nodes", [&](const Location& at) { numbered_node(at, with_parameters ? 4 : 0); });
  }

  /// number x y z, and at most `more` parameters of the place on a curve or surface.
  void numbered_node(const Location& at, long long more) {
    if (words_.size() < 4 || static_cast<long long>(words_.size()) > 4 + more)
      at.fail("a node of " + std::to_string(words_.size()) + " words, expected its number and x y z");
    builder_.add_vertex(at.integer(words_[0]), coordinates(at, 1), at);
  }

  Eigen::Vector3d coordinates(const Location& at, std::size_t first) const {
    return {at.real(words_[first]), at.real(words_[first + 1]), at.real(words_[first + 2])};
  }

  /// All numbers, then all coordinates.
  void block_of_nodes(long long n, long long parameters) {
    std::vector<long long> numbers;
    for (long long i = 0; i < n; ++i) {
      const Location at = block_line("number of a node");
      if (words_.size() != 1)
        at.fail("a number of a node of " + std::to_string(words_.size()) + " words, expected one");
      numbers.push_back(at.integer(words_[0]));
    }
    for (const long long number : numbers) {
      const Location at = block_line("node");
      if (static_cast<long long>(words_.size()) != 3 + parameters)
        at.fail("a node of " + std::to_string(words_.size()) + " words, expected x y z" +
                (parameters > 0 ? " and " + std::to_string(parameters) + " parameters" : ""));
      builder_.add_vertex(number, coordinates(at, 0), at);
    }
  }

  /// Version 1: number type physical elementary nodes-count nodes...; 2: number type tags-count tags...
  /// nodes...; 4: number nodes..., of the type of the block.
  void elements(bool version_1) {
    if (order_) return binary_section("elements", read_gmsh_elements, read_gmsh_2_elements);
    if (version_ != Version::up_to_2)
      return blocks("elements", [&](long long, long long type, long long n) {
        for (long long i = 0; i < n; ++i) element(block_line("element"), type, 1);
      });
    counted("elements", [&](const Location& at) {
      if (words_.size() < (version_1 ? 5U : 3U))
        at.fail("an element of " + std::to_string(words_.size()) +
                " words, expected its number, type and nodes");
      element(at, at.integer(words_[1]), version_1 ? 5 : 3 + count_of(at, words_[2], "tags"));
    });
  }

  void element(const Location& at, long long type, long long before) {
    at.integer(words_[0]);
    const GmshShape shape = gmsh_shape(type, at);
    std::array<long long, 4> nodes{};
    long long corners = 0;
    if (shape >= GmshShape::triangle) {
      corners = gmsh_nodes(type);
      if (static_cast<long long>(words_.size()) - before != corners)
        at.fail((shape == GmshShape::triangle     ? "a triangle of "
                 : shape == GmshShape::quadrangle ? "a quadrangle of "
                                                  : "a tetrahedron of ") +
                std::to_string(words_.size()) + " words, expected " + std::to_string(before) + " and " +
                std::to_string(corners) + " nodes");
      for (long long c = 0; c < corners; ++c)
        nodes[c] = at.integer(words_[static_cast<std::size_t>(before + c)]);
    }
    add_gmsh_element(builder_, type, {nodes.data(), static_cast<std::size_t>(corners)}, at);
  }

  const std::string& source_;
  std::string_view text_;
  LineReader lines_;
  MeshBuilder builder_;
  Words words_;
  Version version_ = Version::up_to_2;
  std::optional<std::endian> order_;  // of a binary file
};

}  // namespace

bool is_binary_gmsh(std::string_view beginning) {
  LineReader lines({}, beginning);
  Words words;
  return lines.next() && trimmed(lines.line()) == "$MeshFormat" && lines.next() &&
         append_words(lines.line(), words) && words.size() == 3 && words[1] == "1";
}

AnyMesh parse_gmsh(const std::string& source, std::string_view text) {
  return GmshReader(source, text).read();
}

}  // namespace springstab
