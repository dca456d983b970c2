#include "solvers/io/stl.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "solvers/io/binary_reader.h"
#include "solvers/io/mesh_builder.h"

namespace springstab {
namespace {

constexpr std::size_t stl_title = 80, stl_count_end = 84, stl_facet = 50;  // bytes

long long stl_facets(std::string_view text) {
  if (text.size() < stl_count_end) return -1;
  return number_of<std::uint32_t>(text.substr(stl_title, 4), std::endian::little);
}

class StlReader {
 public:
  StlReader(const std::string& source, std::string_view text)
      : source_(source), text_(text), builder_(source) {}

  Mesh read() {
    const long long facets = stl_facets(text_);
    const bool is_binary =
        facets >= 0 && text_.size() == stl_count_end + stl_facet * static_cast<std::size_t>(facets);
    if (is_binary || is_binary_stl(text_))
      binary(facets);
    else
      ascii();
    Mesh mesh = std::get<Mesh>(std::move(builder_).finish("facets"));
    mesh.notes.insert(
        mesh.notes.begin(),
        {mesh.face_line.front(), std::to_string(3 * mesh.faces()) + " corners are joined to " +
                                     std::to_string(mesh.vertices.size()) +
                                     " vertices, one for each place, numbered as they first stand here"});
    return mesh;
  }

 private:
  /// normal, three corners (floats), two bytes of attributes.
  void binary(long long facets) {
    BinaryReader bytes(source_, text_, std::endian::little);
    bytes.take(stl_title, "a title of 80 bytes");
    bytes.take(4, "the number of facets");
    if (text_.size() != stl_count_end + stl_facet * static_cast<std::size_t>(facets))
      Location{source_, at_byte(stl_title)}.fail(
          std::to_string(facets) + " facets are announced, expected " +
          std::to_string(stl_count_end + stl_facet * static_cast<std::size_t>(facets)) + " bytes, not " +
          std::to_string(text_.size()));
    for (long long f = 0; f < facets; ++f) {
      const Location at = bytes.at();
      bytes.take(12, "a normal");
      for (long long& corner : corners_) {
        const double x = coordinate(bytes), y = coordinate(bytes), z = coordinate(bytes);
        corner = vertex({x, y, z}, at);
      }
      bytes.take(2, "attributes");
      builder_.add_face(corners_, at);
    }
  }

  static double coordinate(BinaryReader& bytes) { return bytes.finite(NumberType::f32, "a coordinate"); }

  /// One solid or several; names and what they are made of do not matter.
  void ascii() {
    LineReader lines(source_, text_);
    std::vector<std::string_view> words;
    const auto next = [&](const char* expected) {
      words.clear();
      while (words.empty() && lines.next()) append_words(lines.line(), words);
      if (words.empty() && expected) lines.at().fail(std::string("the file ends, expected ") + expected);
      return !words.empty();
    };
    const auto expect = [&](std::string_view keyword, std::string_view second, std::size_t size) {
      next(keyword.data());
      if (lowercase(words[0]) != keyword ||
          (!second.empty() && (words.size() < 2 || lowercase(words[1]) != second)) ||
          (size > 0 && words.size() != size))
        lines.at().fail(quoted(lines.line()) + " stands here, expected '" + std::string(keyword) +
                        (second.empty() ? "" : " " + std::string(second)) + (size == 4 ? " X Y Z'" : "'"));
    };
    for (expect("solid", "", 0); !words.empty();) {
      for (next("facet or endsolid"); lowercase(words[0]) == "facet"; next("facet or endsolid")) {
        const Location at = lines.at();
        if (words.size() != 5 || lowercase(words[1]) != "normal")
          at.fail(quoted(lines.line()) + " stands here, expected 'facet normal X Y Z'");
        expect("outer", "loop", 2);
        for (long long& corner : corners_) {
          expect("vertex", "", 4);
          corner = vertex({lines.at().real(words[1]), lines.at().real(words[2]), lines.at().real(words[3])},
                          lines.at());
        }
        expect("endloop", "", 1);
        expect("endfacet", "", 1);
        builder_.add_face(corners_, at);
      }
      if (lowercase(words[0]) != "endsolid")
        lines.at().fail(quoted(lines.line()) + " stands here, expected facet or endsolid");
      if (next(nullptr) && lowercase(words[0]) != "solid")
        lines.at().fail(quoted(lines.line()) + " stands here, expected solid or the end of the file");
    }
  }

  /// That at this place: 0 and -0 are one coordinate.
  long long vertex(const std::array<double, 3>& place, const Location& at) {
    const auto [found, added] = vertices_.emplace(place, static_cast<long long>(vertices_.size()));
    if (added) builder_.add_vertex(found->second, {place[0], place[1], place[2]}, at);
    return found->second;
  }

  const std::string& source_;
  std::string_view text_;
  MeshBuilder builder_;
  std::map<std::array<double, 3>, long long> vertices_;
  std::array<long long, 3> corners_{};
};

}  // namespace

bool is_binary_stl(std::string_view beginning) {
  const std::string_view text = trimmed(beginning.substr(0, 1024));
  const bool is_text = text.starts_with("solid") && text.find("facet") != text.npos;
  return !is_text && stl_facets(beginning) > 0 && beginning.find('\0') != beginning.npos;
}

Mesh parse_stl(const std::string& source, std::string_view text) { return StlReader(source, text).read(); }

}  // namespace springstab
