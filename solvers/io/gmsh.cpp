#include "solvers/io/gmsh.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

/// Element types: points and lines, of any order; and curved surfaces, which have nodes within their edges.
constexpr auto gmsh_skipped = std::to_array<long long>({1, 8, 15, 26, 27, 28});
constexpr auto gmsh_curved_surfaces = std::to_array<long long>({9, 10, 16, 20, 21, 22, 23, 24, 25});
constexpr auto gmsh_curved_tetrahedra = std::to_array<long long>({11, 29, 30, 31});
constexpr long long gmsh_triangle = 2, gmsh_quadrangle = 3, gmsh_tetrahedron = 4;

class GmshReader {
 public:
  GmshReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

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
        while (next_words() && words_.front() != end) {
        }
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
    if (words_[1] != "0") at.fail(binary_file_message("$MeshFormat"));
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
    if (is_among(gmsh_skipped, type)) return;
    const std::string kind = "an element of type " + std::to_string(type);
    const std::string order = ", which has nodes between its corners, expected first order (gmsh -order 1)";
    if (is_among(gmsh_curved_surfaces, type)) return builder_.add_unusable_face(at, kind + order);
    if (is_among(gmsh_curved_tetrahedra, type)) at.fail(kind + order);
    if (type != gmsh_triangle && type != gmsh_quadrangle && type != gmsh_tetrahedron)
      at.fail(kind + ", expected triangles, quadrangles or tetrahedra (types 2, 3 and 4)");
    const long long corners = type == gmsh_triangle ? 3 : 4;
    if (static_cast<long long>(words_.size()) - before != corners)
      at.fail((type == gmsh_triangle     ? "a triangle of "
               : type == gmsh_quadrangle ? "a quadrangle of "
                                         : "a tetrahedron of ") +
              std::to_string(words_.size()) + " words, expected " + std::to_string(before) + " and " +
              std::to_string(corners) + " nodes");
    std::array<long long, 4> nodes{};
    for (long long c = 0; c < corners; ++c)
      nodes[c] = at.integer(words_[static_cast<std::size_t>(before + c)]);
    if (type == gmsh_tetrahedron) return builder_.add_tet(nodes, at);
    builder_.add_face({nodes.data(), static_cast<std::size_t>(corners)}, at);
  }

  LineReader lines_;
  MeshBuilder builder_;
  Words words_;
  Version version_ = Version::up_to_2;
};

}  // namespace

AnyMesh parse_gmsh(const std::string& source, std::string_view text) {
  return GmshReader(source, text).read();
}

}  // namespace springstab
