#include "solvers/io/obj.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

/// What a face belongs to.
constexpr auto obj_attributes = std::to_array<std::string_view>({"g", "o", "s", "usemtl", "mtllib"});

/// What the format has and a polygon mesh does not need.
constexpr auto obj_skipped = std::to_array<std::string_view>(
    {"vn", "mg", "bevel", "c_interp", "d_interp", "lod", "usemap", "maplib", "shadow_obj", "trace_obj"});

/// What would add to the geometry, or belongs to its vertices, and is left out: points, lines, free-form
/// curves and surfaces with all that they consist of; and from other programs than the format's first,
/// weights and colours of vertices and the creases of subdivision surfaces. `call` and `csh` are in neither
/// list: they bring in other files.
constexpr auto obj_left_out = std::to_array<std::string_view>(
    {"p",     "l",    "vp",   "cstype", "deg",  "bmat", "step", "curv", "curv2",
     "surf",  "parm", "trim", "hole",   "scrv", "sp",   "end",  "con",  "ctech",
     "stech", "bsp",  "bzp",  "cdc",    "cdp",  "res",  "vw",   "vc",   "t"});

/// Collects the words of the next statement: one line, or several where a line ends in a backslash.
/// Returns where it begins; line 0 once the file has ended.
Location next_statement(LineReader& lines, Words& words) {
  words.clear();
  Location begin;
  for (bool continued = true; continued && lines.next();) {
    if (begin.line == 0) begin = lines.at();
    std::string_view line = trimmed(lines.line());
    continued = line.ends_with('\\');
    if (continued) line.remove_suffix(1);
    continued = append_words(line, words, '#') && continued;
  }
  return begin;
}

/// All but the first.
std::string joined(const Words& words) {
  std::string line;
  for (const std::string_view word : std::span(words).subspan(1))
    line.append(line.empty() ? "" : " ").append(word);
  return line;
}

/// Things of one kind that are dropped or not used: how many, and the line of the first.
struct Tally {
  long count = 0, line = 0;
  void add(const Location& at) {
    if (count++ == 0) line = at.line;
  }
};

/// `v` x y z, and unused behind them: a weight, a colour (three numbers) or both.
Eigen::Vector3d parse_vertex(const Words& words, const Location& at, Tally& not_finite) {
  const std::size_t count = words.size() - 1;
  if (count != 3 && count != 4 && count != 6 && count != 7)
    at.fail("a vertex with " + std::to_string(count) +
            " numbers, expected x y z and at most a weight and a colour (r g b) after them");
  const auto unused = std::span(words).subspan(4);
  if (std::ranges::any_of(unused, is_not_finite)) not_finite.add(at);
  for (const std::string_view word : unused)
    if (!is_not_finite(word)) at.real(word);
  return {at.real(words[1]), at.real(words[2]), at.real(words[3])};
}

[[noreturn]] void fail_index(const std::string& kind, long long index, const std::string& expected,
                             const Location& at) {
  at.fail(kind + " index " + std::to_string(index) + " is out of range, expected " + expected);
}

/// `vt` u, and v and a depth that default to 0; the depth is not used.
Eigen::Vector2d parse_texture(const Words& words, const Location& at, Tally& not_finite) {
  std::array<double, 3> numbers{};
  const std::size_t count = words.size() - 1;
  if (count < 1 || count > 3)
    at.fail("texture coordinates with " + std::to_string(count) + " numbers, expected u, u v or u v w");
  if (std::ranges::any_of(words, is_not_finite)) not_finite.add(at);
  for (std::size_t i = 0; i < count; ++i)
    if (!is_not_finite(words[i + 1])) numbers[i] = at.real(words[i + 1]);
  return {numbers[0], numbers[1]};
}

/// The place, from 0, that an index names. A negative one counts back from the last so far; a positive one
/// may point ahead, so its upper bound is left to check_indices.
int place(long long index, const std::string& kind, const std::string& things, std::size_t so_far,
          const Location& at) {
  const auto last = static_cast<long long>(so_far);
  if (index == 0 || index > std::numeric_limits<int>::max())
    fail_index(kind, index, "an index from 1 (or from -1 back)", at);
  if (index < -last)
    fail_index(kind, index, "at least -" + std::to_string(last) + " (the " + things + " so far)", at);
  return static_cast<int>(index > 0 ? index - 1 : last + index);
}

/// The indices of a corner i, i/t, i/t/n or i//n; 0 for one that is left out. Some programs write the slashes
/// of what they leave out (i//, i/t/), or 0 in its place.
std::array<long long, 3> parse_corner(std::string_view word, const Location& at) {
  std::array<long long, 3> indices{};
  std::string_view rest = word;
  std::size_t slash = 0;
  for (std::size_t i = 0; i < indices.size() && slash != rest.npos; ++i) {
    slash = rest.find('/');
    const std::string_view index = rest.substr(0, slash);
    if (i == 0 && index.empty())
      at.fail("the corner " + quoted(word) + " lacks its vertex, expected i, i/t, i/t/n or i//n");
    if (!index.empty()) indices[i] = at.integer(index);
    if (slash != rest.npos) rest.remove_prefix(slash + 1);
  }
  if (slash != rest.npos)
    at.fail("the corner " + quoted(word) + " has more than three indices, expected i, i/t, i/t/n or i//n");
  return indices;
}

class ObjReader {
 public:
  explicit ObjReader(const std::string& source) { mesh_.source = source; }

  Mesh read(std::string_view text) {
    LineReader lines(mesh_.source, text);
    Words words;
    while (true) {
      const Location at = next_statement(lines, words);
      if (at.line == 0) break;
      if (!words.empty()) statement(words, at);
    }
    if (mesh_.vertices.empty())
      throw InputError(mesh_.source, 0, "no vertices, expected lines such as 'v 0 0 0'");
    if (mesh_.faces() == 0)
      throw InputError(
          mesh_.source, short_faces_.line,
          std::string(short_faces_.count > 0 ? "no face has three or more corners" : "no faces") +
              ", expected lines such as 'f 1 2 3'");
    check_indices();
    use_textures();
    tell();
    if (!textures_.empty() && coordinates_.count == 0) {
      mesh_.attributes.textures = std::move(textures_);
      mesh_.attributes.corner_textures = std::move(corner_textures_);
    }
    return std::move(mesh_);
  }

 private:
  void statement(const Words& words, const Location& at) {
    const std::string_view keyword = words.front();
    if (keyword == "v") {
      mesh_.vertices.push_back(parse_vertex(words, at, colours_));
      mesh_.vertex_line.push_back(at.line);
    } else if (keyword == "vt") {
      textures_.push_back(parse_texture(words, at, coordinates_));
    } else if (keyword == "f" || keyword == "fo") {  // "fo": what old files call it
      face(words, at);
    } else if (is_among(obj_attributes, keyword)) {
      mesh_.attributes.statements.push_back({mesh_.faces(), std::string(keyword), joined(words)});
    } else if (is_among(obj_left_out, keyword)) {
      left_out_[keyword].add(at);
    } else if (!is_among(obj_skipped, keyword)) {
      at.fail("unknown statement " + quoted(keyword) +
              ", expected one of Wavefront OBJ's such as v, f, vt or g");
    }
  }

  void face(const Words& words, const Location& at) {
    if (words.size() < 2) at.fail("a face with 0 corners, expected 3 or more");
    const bool dropped = words.size() < 4;
    if (dropped) short_faces_.add(at);
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto [vertex, texture, normal] = parse_corner(words[i], at);
      const int corner = place(vertex, "vertex", "vertices", mesh_.vertices.size(), at);
      if (dropped) continue;
      mesh_.face_vertices.push_back(corner);
      corner_textures_.push_back(texture_place(texture, at));
    }
    if (dropped) return;
    mesh_.face_offsets.push_back(static_cast<int>(mesh_.face_vertices.size()));
    mesh_.face_line.push_back(at.line);
  }

  /// A file without texture coordinates may yet name them.
  int texture_place(long long index, const Location& at) {
    if (index == 0) return none;
    if (index > 0 || !textures_.empty())
      return place(index, "texture", "texture coordinates", textures_.size(), at);
    if (!early_) early_ = {index, at};
    return none;
  }

  void check_indices() const {
    const auto vertices = static_cast<int>(mesh_.vertices.size()),
               textures = static_cast<int>(textures_.size());
    if (early_ && textures > 0)
      fail_index("texture", early_->first, "an index from 1, for no texture coordinates stand before it",
                 early_->second);
    for (int f = 0; f < mesh_.faces(); ++f) {
      const Location at{mesh_.source, mesh_.face_line[static_cast<std::size_t>(f)]};
      for (int corner = mesh_.face_offsets[f]; corner < mesh_.face_offsets[f + 1]; ++corner) {
        if (const int vertex = mesh_.face_vertices[corner]; vertex >= vertices)
          fail_index("vertex", vertex + 1LL,
                     "at most " + std::to_string(vertices) + " (the vertices of the file)", at);
        if (const int texture = corner_textures_[corner]; texture >= textures && textures > 0)
          fail_index("texture", texture + 1LL,
                     "at most " + std::to_string(textures) + " (the texture coordinates of the file)", at);
      }
    }
  }

  /// Only where all corners have coordinates, and all coordinates are numbers.
  void use_textures() {
    for (int f = 0; f < mesh_.faces() && textures_.empty(); ++f)
      if (corner_textures_[mesh_.face_offsets[f]] != none)
        unnamed_.add({mesh_.source, mesh_.face_line[static_cast<std::size_t>(f)]});
    if (early_) unnamed_.add(early_->second);
    if (textures_.empty() || coordinates_.count > 0 || is_among(corner_textures_, int{none})) return;
    for (const int texture : corner_textures_) mesh_.corner_uv.push_back(textures_[texture]);
  }

  void tell() {
    const auto note = [this](const Tally& tally, const std::string& one, const std::string& many) {
      if (tally.count > 0)
        mesh_.notes.push_back({tally.line, tally.count == 1 ? one : std::to_string(tally.count) + many});
    };
    note(short_faces_, "dropped a face of one or two corners", " faces of one or two corners are dropped");
    for (const auto& [keyword, tally] : left_out_)
      note(tally, "the statement " + quoted(keyword) + " is not used",
           " statements " + quoted(keyword) + " are not used");
    note(colours_, "a weight or colour that is no number, which is not used",
         " vertices have a weight or colour that is no number, which is not used");
    note(coordinates_, "no texture coordinates are used, for these are no numbers",
         " texture coordinates are no numbers, and none are used");
    if (unnamed_.count > 0)
      mesh_.notes.push_back({unnamed_.line, "texture coordinates are named, but the file has none"});
  }

  static constexpr int none = -1;

  Mesh mesh_;
  std::vector<Eigen::Vector2d> textures_;                // of the file
  std::vector<int> corner_textures_;                     // of the corners
  std::optional<std::pair<long long, Location>> early_;  // the first index back from where none is yet
  std::map<std::string_view, Tally> left_out_;           // by the statement
  Tally short_faces_, colours_, coordinates_, unnamed_;
};

}  // namespace

Mesh parse_obj(const std::string& source, std::string_view text) {
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(source, 0,
                     "the file has more than 2^31 - 1 bytes, expected a smaller mesh");  // indices are int
  return ObjReader(source).read(text);
}

Mesh read_obj(const std::string& path) { return parse_obj(path, read_text_file(path)); }

}  // namespace springstab
