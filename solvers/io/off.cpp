#include "solvers/io/off.h"

#include <utility>
#include <vector>

#include "solvers/io/mesh_builder.h"

namespace springstab {
namespace {

class OffReader {
 public:
  OffReader(const std::string& source, std::string_view text) : lines_(source, text), builder_(source) {}

  Mesh read() {
    header();
    const Location counts_at = lines_.at();
    const long long vertices = count_of(counts_at, words_[0], "vertices"),
                    faces = count_of(counts_at, words_[1], "faces");
    for (long long v = 0; v < vertices; ++v) vertex(v);
    for (long long f = 0; f < faces; ++f) face();
    if (next_words())
      lines_.at().fail(quoted(lines_.line()) + " stands behind the last face, expected the end of the file");
    return std::get<Mesh>(std::move(builder_).finish("faces of three or more corners"));
  }

 private:
  /// The next line with words that are no comment; false at the end.
  bool next_words() {
    words_.clear();
    while (words_.empty() && lines_.next()) append_words(lines_.line(), words_, '#');
    return !words_.empty();
  }

  void expect_words(const std::string& expected) {
    if (!next_words()) lines_.at().fail("the file ends, expected " + expected);
  }

  /// OFF with its prefixes, and in that line or the next the counts of vertices, faces and edges.
  void header() {
    constexpr const char* counts = "numbers of vertices, faces and edges";
    expect_words("OFF");
    const std::string first(words_[0]);
    std::string_view prefix = first;
    const bool named = prefix.ends_with("OFF");
    if (named) prefix.remove_suffix(3);
    const std::string_view all = prefix;
    for (const std::string_view part : {"ST", "C", "N"})
      if (prefix.starts_with(part)) prefix.remove_prefix(part.size());
    if (!named || !prefix.empty())
      lines_.at().fail(springstab::quoted(first) +
                       " begins the file, expected OFF, perhaps with ST, C or N before it");
    more_ = !all.empty();
    words_.erase(words_.begin());
    if (!words_.empty() && words_[0] == "BINARY")
      lines_.at().fail("the file is binary, expected text: `geomview -wa` or meshlab saves it");
    if (words_.empty()) expect_words(counts);
    if (words_.size() != 2 && words_.size() != 3)
      lines_.at().fail(quoted(lines_.line()) + " has " + std::to_string(words_.size()) +
                       " numbers, expected " + counts);
  }

  void vertex(long long number) {
    expect_words("vertices");
    const Location at = lines_.at();
    if (words_.size() < 3 || (words_.size() > 3 && !more_ && words_.size() != 6 && words_.size() != 7))
      at.fail("a vertex of " + std::to_string(words_.size()) + " numbers, expected x y z");
    for (std::size_t i = 3; i < words_.size(); ++i)
      if (!is_not_finite(words_[i])) at.real(words_[i]);
    builder_.add_vertex(number, {at.real(words_[0]), at.real(words_[1]), at.real(words_[2])}, at);
  }

  /// The number of corners, the corners, and a colour of up to four numbers or the name of one.
  void face() {
    expect_words("faces");
    const Location at = lines_.at();
    const long long corners = count_of(at, words_[0], "corners");
    const auto behind = static_cast<long long>(words_.size()) - 1;
    if (behind < corners || behind > corners + 4)
      at.fail("a face of " + std::to_string(corners) + " corners with " + std::to_string(behind) +
              " numbers behind that, expected the corners and at most a colour");
    corners_.clear();
    for (long long c = 1; c <= corners; ++c)
      corners_.push_back(at.integer(words_[static_cast<std::size_t>(c)]));
    builder_.add_face(corners_, at);
  }

  LineReader lines_;
  MeshBuilder builder_;
  std::vector<std::string_view> words_;
  std::vector<long long> corners_;
  bool more_ = false;  // numbers for each vertex than x y z
};

}  // namespace

Mesh parse_off(const std::string& source, std::string_view text) { return OffReader(source, text).read(); }

}  // namespace springstab
