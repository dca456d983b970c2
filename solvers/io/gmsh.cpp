#include "solvers/io/gmsh.h"

#include <algorithm>
#include <array>
#include <vector>

#include "solvers/io/tet_builder.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view wanted = "version 1 or 2 in ASCII (gmsh -format msh22 writes it)";

/// Points, lines and surfaces, of any order: what a solid does not need.
constexpr auto skipped_gmsh_types =
    std::to_array<long long>({1, 2, 3, 8, 9, 10, 15, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28});

class GmshReader {
 public:
  GmshReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

  TetMesh read() {
    while (next_words()) {
      const std::string section(words_.front());
      if (!section.starts_with('$') || section.starts_with("$End") || section.starts_with("$END"))
        lines_.at().fail(quoted(section) + " begins no section, expected one such as $Nodes or $NOD");
      if (section == "$MeshFormat") {
        format();
      } else if (section == "$Nodes" || section == "$NOD") {
        nodes();
      } else if (section == "$Elements" || section == "$ELM") {
        elements(section == "$ELM");
      } else {
        skip();
      }
      const std::string end = (section == "$NOD" || section == "$ELM" ? "$END" : "$End") + section.substr(1);
      if (words_.empty() || words_.front() != end)
        lines_.at().fail("the section " + quoted(section) + " does not end here, expected " + quoted(end));
    }
    return builder_.finish("elements of type 4");
  }

 private:
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
    if (!words_[0].starts_with("2"))
      at.fail("the format is version " + quoted(words_[0]) + ", expected " + std::string(wanted));
    if (words_[1] != "0") at.fail("the file is binary, expected " + std::string(wanted));
    next_words();
  }

  /// Reads lines until the section's end, as many as its first line announces.
  template <class Line>
  void counted(const std::string& things, const Line& line) {
    if (!next_line()) lines_.at().fail("no number of " + things + ", expected one");
    const Location announced = lines_.at();
    if (words_.size() != 1)
      announced.fail(quoted(lines_.line()) + " is no number of " + things + ", expected one number");
    const long long count = count_of(announced, words_[0], things);
    long long found = 0;
    for (; next_line(); ++found) line(lines_.at());
    check_count(lines_.at(), things, found, count);
  }

  void nodes() {
    counted("nodes", [&](const Location& at) {
      if (words_.size() != 4)
        at.fail("a node of " + std::to_string(words_.size()) + " words, expected its number and x y z");
      builder_.add_vertex(at.integer(words_[0]), {at.real(words_[1]), at.real(words_[2]), at.real(words_[3])},
                          at);
    });
  }

  /// number type physical elementary nodes-count nodes... (version 1), number type tags-count tags...
  /// nodes...
  void elements(bool version_1) {
    counted("elements", [&](const Location& at) {
      if (words_.size() < (version_1 ? 5U : 3U))
        at.fail("an element of " + std::to_string(words_.size()) +
                " words, expected its number, type and nodes");
      at.integer(words_[0]);
      const long long type = at.integer(words_[1]);
      if (std::ranges::find(skipped_gmsh_types, type) != skipped_gmsh_types.end()) return;
      if (type != 4)
        at.fail("an element of type " + std::to_string(type) +
                ", expected tetrahedra of first order (type 4)");
      const long long before = version_1 ? 5 : 3 + count_of(at, words_[2], "tags");
      if (static_cast<long long>(words_.size()) - before != 4)
        at.fail("a tetrahedron of " + std::to_string(words_.size()) + " words, expected " +
                std::to_string(before) + " and four nodes");
      std::array<long long, 4> corners{};
      for (int c = 0; c < 4; ++c) corners[c] = at.integer(words_[static_cast<std::size_t>(before + c)]);
      builder_.add_tet(corners, at);
    });
  }

  void skip() {
    while (next_words() && !words_.front().starts_with("$")) {
    }
  }

  LineReader lines_;
  TetBuilder builder_;
  Words words_;
};

}  // namespace

TetMesh parse_gmsh(const std::string& source, std::string_view text) {
  return GmshReader(source, text).read();
}

}  // namespace springstab
