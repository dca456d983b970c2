#include "solvers/io/obj.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"

namespace springstab {
namespace {

using Words = std::vector<std::string_view>;

/// What the format has and a polygon mesh does not need. `call` and `csh` are not among them: they bring in
/// other files, and skipping those would silently lose geometry.
constexpr auto skipped_keywords = std::to_array<std::string_view>(
    {"vn",       "vp",    "cstype", "deg",    "bmat",   "step",   "p",          "l",
     "curv",     "curv2", "surf",   "parm",   "trim",   "hole",   "scrv",       "sp",
     "end",      "con",   "g",      "s",      "mg",     "o",      "bevel",      "c_interp",
     "d_interp", "lod",   "usemap", "usemtl", "mtllib", "maplib", "shadow_obj", "trace_obj",
     "ctech",    "stech", "bsp",    "bzp",    "cdc",    "cdp",    "res"});

/// Collects the words of the next statement: one line, or several where a line ends in a backslash.
/// Returns where it begins; line 0 once the file has ended.
Location next_statement(LineReader& lines, Words& words) {
  words.clear();
  Location begin;
  for (bool continued = true; continued && lines.next();) {
    if (begin.line == 0) begin = lines.at();
    std::string_view line = lines.line();
    line = line.substr(0, line.find('#'));
    continued = line.ends_with('\\');
    if (continued) line.remove_suffix(1);
    append_words(line, words);
  }
  return begin;
}

/// `v` x y z, and unused behind them: a weight, a colour (three numbers) or both.
Eigen::Vector3d parse_vertex(const Words& words, const Location& at) {
  std::array<double, 7> numbers{};
  const std::size_t count = words.size() - 1;
  if (count != 3 && count != 4 && count != 6 && count != 7)
    at.fail("a vertex with " + std::to_string(count) +
            " numbers, expected x y z and at most a weight and a colour (r g b) after them");
  for (std::size_t i = 0; i < count; ++i) numbers[i] = at.real(words[i + 1]);
  return {numbers[0], numbers[1], numbers[2]};
}

[[noreturn]] void fail_index(const std::string& kind, long long index, const std::string& expected,
                             const Location& at) {
  at.fail(kind + " index " + std::to_string(index) + " is out of range, expected " + expected);
}

/// `vt` u, and v and a depth that default to 0; the depth is not used.
Eigen::Vector2d parse_texture(const Words& words, const Location& at) {
  std::array<double, 3> numbers{};
  const std::size_t count = words.size() - 1;
  if (count < 1 || count > 3)
    at.fail("texture coordinates with " + std::to_string(count) + " numbers, expected u, u v or u v w");
  for (std::size_t i = 0; i < count; ++i) numbers[i] = at.real(words[i + 1]);
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

/// A corner i, i/t, i/t/n or i//n: its vertex and its texture coordinates, from 0, or -1 for none.
struct Corner {
  int vertex, texture;
};

Corner parse_corner(std::string_view word, std::size_t vertices_so_far, std::size_t textures_so_far,
                    const Location& at) {
  if (word.starts_with('/') || word.ends_with('/'))
    at.fail("the corner " + quoted(word) + " lacks an index, expected i, i/t, i/t/n or i//n");
  const std::size_t slash = word.find('/');
  const long long vertex = at.integer(word.substr(0, slash));
  std::optional<long long> texture;
  if (slash != word.npos) {
    const std::string_view more = word.substr(slash + 1);
    const std::size_t second = more.find('/');
    if (second != 0) texture = at.integer(more.substr(0, second));
    if (second != more.npos) at.integer(more.substr(second + 1));  // a normal: not used, but must be an index
  }
  return {place(vertex, "vertex", "vertices", vertices_so_far, at),
          texture ? place(*texture, "texture", "texture coordinates", textures_so_far, at) : -1};
}

/// textures: of the corners, among `texture_count` in the file.
void check_indices(const Mesh& mesh, const std::vector<int>& textures, std::size_t texture_count) {
  const auto vertices = static_cast<int>(mesh.vertices.size());
  for (int f = 0; f < mesh.faces(); ++f) {
    const Location at{mesh.source, mesh.face_line[static_cast<std::size_t>(f)]};
    for (int corner = mesh.face_offsets[f]; corner < mesh.face_offsets[f + 1]; ++corner) {
      if (const int vertex = mesh.face_vertices[corner]; vertex >= vertices)
        fail_index("vertex", vertex + 1LL,
                   "at most " + std::to_string(vertices) + " (the vertices of the file)", at);
      if (const int texture = textures[corner]; texture >= static_cast<int>(texture_count))
        fail_index("texture", texture + 1LL,
                   "at most " + std::to_string(texture_count) + " (the texture coordinates of the file)", at);
    }
  }
}

}  // namespace

Mesh parse_obj(const std::string& source, std::string_view text) {
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(source, 0,
                     "the file has more than 2^31 - 1 bytes, expected a smaller mesh");  // indices are int
  Mesh mesh;
  mesh.source = source;
  LineReader lines(mesh.source, text);
  Words words;
  std::vector<Eigen::Vector2d> textures;  // of the file
  std::vector<int> corner_textures;       // of the corners, -1 for none
  while (true) {
    const Location at = next_statement(lines, words);
    if (at.line == 0) break;
    if (words.empty()) continue;
    const std::string_view keyword = words.front();
    if (keyword == "v") {
      mesh.vertices.push_back(parse_vertex(words, at));
      mesh.vertex_line.push_back(at.line);
    } else if (keyword == "vt") {
      textures.push_back(parse_texture(words, at));
    } else if (keyword == "f" || keyword == "fo") {  // "fo": what old files call it
      if (words.size() < 4)
        at.fail("a face with " + std::to_string(words.size() - 1) + " corners, expected 3 or more");
      for (std::size_t i = 1; i < words.size(); ++i) {
        const Corner corner = parse_corner(words[i], mesh.vertices.size(), textures.size(), at);
        mesh.face_vertices.push_back(corner.vertex);
        corner_textures.push_back(corner.texture);
      }
      mesh.face_offsets.push_back(static_cast<int>(mesh.face_vertices.size()));
      mesh.face_line.push_back(at.line);
    } else if (std::ranges::find(skipped_keywords, keyword) == skipped_keywords.end()) {
      at.fail("unknown statement " + quoted(keyword) +
              ", expected one of Wavefront OBJ's such as v, f, vt or g");
    }
  }
  if (mesh.vertices.empty()) throw InputError(source, 0, "no vertices, expected lines such as 'v 0 0 0'");
  if (mesh.faces() == 0) throw InputError(source, 0, "no faces, expected lines such as 'f 1 2 3'");
  check_indices(mesh, corner_textures, textures.size());
  if (std::ranges::find(corner_textures, -1) == corner_textures.end())
    for (const int texture : corner_textures) mesh.corner_uv.push_back(textures[texture]);
  return mesh;
}

Mesh read_obj(const std::string& path) { return parse_obj(path, read_text_file(path)); }

}  // namespace springstab
