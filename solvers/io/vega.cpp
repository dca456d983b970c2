#include "solvers/io/vega.h"

#include <array>
#include <vector>

#include "solvers/io/mesh_builder.h"

namespace springstab {
namespace {

class VegaReader {
 public:
  VegaReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

  TetMesh read() {
    bool more = next_words();
    while (more) {
      const Location at = lines_.at();
      const std::string_view section = words_.front();
      if (section == "*VERTICES") {
        more = vertices();
      } else if (section == "*ELEMENTS") {
        more = elements();
      } else if (section == "*MATERIAL" || section == "*REGION" || section == "*SET") {
        while ((more = next_words()) && (!words_.front().starts_with('*') || words_.front() == "*INCLUDE")) {
        }
      } else if (section == "*INCLUDE") {
        included();
      } else {
        at.fail("unknown section " + quoted(section) +
                ", expected *VERTICES, *ELEMENTS, *MATERIAL, *REGION or *SET");
      }
    }
    return std::get<TetMesh>(std::move(builder_).finish("a section *ELEMENTS of kind TET"));
  }

 private:
  /// The next line that is neither blank nor a comment; false at the end.
  bool next_words() {
    words_.clear();
    while (words_.empty() && lines_.next()) append_words(lines_.line(), words_, '#');
    return !words_.empty();
  }

  [[noreturn]] void included() const {
    lines_.at().fail("vertices or elements of another file (" + quoted(lines_.line()) +
                     "), expected them in this one, in place of this line");
  }

  void expect_line(const std::string& what) {
    const bool more = next_words();
    if (more && words_.front() == "*INCLUDE") included();
    if (!more || words_.front().starts_with('*')) lines_.at().fail("no " + what + ", expected them here");
  }

  /// Reads the lines of a section, as many as announced; true if another section follows.
  template <class Line>
  bool counted(const std::string& things, long long announced, const Line& line) {
    long long found = 0;
    bool more = false;
    while ((more = next_words()) && !words_.front().starts_with('*')) {
      line(lines_.at());
      ++found;
    }
    if (more && words_.front() == "*INCLUDE") included();
    check_count(lines_.at(), things, found, announced);
    return more;
  }

  /// count, dimension, attributes, boundary markers; then number x y z (attributes, markers).
  bool vertices() {
    expect_line("numbers of vertices and dimensions");
    const Location at = lines_.at();
    if (words_.size() != 4 || words_[1] != "3")
      at.fail(quoted(lines_.line()) +
              " before the vertices, expected their number, 3, and the numbers of attributes and markers");
    const long long extra = count_of(at, words_[2], "attributes") + (count_of(at, words_[3], "markers") > 0);
    return counted("vertices", count_of(at, words_[0], "vertices"), [&](const Location& here) {
      if (static_cast<long long>(words_.size()) - 4 != extra)
        here.fail("a vertex of " + std::to_string(words_.size()) + " words, expected its number, x y z and " +
                  std::to_string(extra) + " more");
      builder_.add_vertex(here.integer(words_[0]),
                          {here.real(words_[1]), here.real(words_[2]), here.real(words_[3])}, here);
    });
  }

  /// TET; count, corners, attributes; then number and corners (attributes).
  bool elements() {
    expect_line("kind of elements");
    if (words_.size() != 1 || (words_[0] != "TET" && words_[0] != "TETS"))
      lines_.at().fail("elements of kind " + quoted(lines_.line()) + ", expected TET");
    expect_line("numbers of elements and corners");
    const Location at = lines_.at();
    if (words_.size() != 3 || words_[1] != "4")
      at.fail(quoted(lines_.line()) +
              " before the elements, expected their number, 4, and the number of attributes");
    const long long extra = count_of(at, words_[2], "attributes");
    return counted("elements", count_of(at, words_[0], "elements"), [&](const Location& here) {
      if (static_cast<long long>(words_.size()) - 5 != extra)
        here.fail("a tetrahedron of " + std::to_string(words_.size()) +
                  " words, expected its number, four corners and " + std::to_string(extra) + " more");
      here.integer(words_[0]);
      std::array<long long, 4> corners{};
      for (std::size_t c = 0; c < 4; ++c) corners[c] = here.integer(words_[c + 1]);
      builder_.add_tet(corners, here);
    });
  }

  LineReader lines_;
  MeshBuilder builder_;
  std::vector<std::string_view> words_;
};

}  // namespace

TetMesh parse_vega(const std::string& source, std::string_view text) {
  return VegaReader(source, text).read();
}

}  // namespace springstab
