#include "solvers/io/obj.h"

#include <algorithm>
#include <array>
#include <limits>
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
    {"vt",        "vn",       "vp",    "cstype", "deg",    "bmat",   "step",   "p",
     "l",         "curv",     "curv2", "surf",   "parm",   "trim",   "hole",   "scrv",
     "sp",        "end",      "con",   "g",      "s",      "mg",     "o",      "bevel",
     "c_interp",  "d_interp", "lod",   "usemap", "usemtl", "mtllib", "maplib", "shadow_obj",
     "trace_obj", "ctech",    "stech", "bsp",    "bzp",    "cdc",    "cdp",    "res"});

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

[[noreturn]] void fail_index(long long index, const std::string& expected, const Location& at) {
  at.fail("vertex index " + std::to_string(index) + " is out of range, expected " + expected);
}

/// The vertex, from 0, of a corner i, i/t, i/t/n or i//n. A negative i counts back from the last vertex so
/// far; a positive one may point ahead, so its upper bound is left to check_indices.
int parse_corner(std::string_view word, std::size_t vertices_so_far, const Location& at) {
  if (word.starts_with('/') || word.ends_with('/'))
    at.fail("the corner " + quoted(word) + " lacks an index, expected i, i/t, i/t/n or i//n");
  const std::size_t slash = word.find('/');
  const long long index = at.integer(word.substr(0, slash));
  if (slash != word.npos) {  // the texture and normal indices are not used, but must be indices
    const std::string_view unused = word.substr(slash + 1);
    const std::size_t second = unused.find('/');
    if (second != 0) at.integer(unused.substr(0, second));
    if (second != unused.npos) at.integer(unused.substr(second + 1));
  }
  const auto so_far = static_cast<long long>(vertices_so_far);
  if (index == 0 || index > std::numeric_limits<int>::max())
    fail_index(index, "an index from 1 (or from -1 back)", at);
  if (index < -so_far)
    fail_index(index, "at least -" + std::to_string(so_far) + " (the vertices so far)", at);
  return static_cast<int>(index > 0 ? index - 1 : so_far + index);
}

void check_indices(const Mesh& mesh) {
  const auto vertices = static_cast<int>(mesh.vertices.size());
  for (int f = 0; f < mesh.faces(); ++f)
    for (const int vertex : mesh.face(f))
      if (vertex >= vertices)
        fail_index(vertex + 1LL, "at most " + std::to_string(vertices) + " (the vertices of the file)",
                   {mesh.source, mesh.face_line[static_cast<std::size_t>(f)]});
}

}  // namespace

Mesh read_obj(const std::string& path) {
  const std::string text = read_text_file(path);
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(path, 0,
                     "the file has more than 2^31 - 1 bytes, expected a smaller mesh");  // indices are int
  Mesh mesh;
  mesh.source = path;
  LineReader lines(mesh.source, text);
  Words words;
  while (true) {
    const Location at = next_statement(lines, words);
    if (at.line == 0) break;
    if (words.empty()) continue;
    const std::string_view keyword = words.front();
    if (keyword == "v") {
      mesh.vertices.push_back(parse_vertex(words, at));
      mesh.vertex_line.push_back(at.line);
    } else if (keyword == "f" || keyword == "fo") {  // "fo": what old files call it
      if (words.size() < 4)
        at.fail("a face with " + std::to_string(words.size() - 1) + " corners, expected 3 or more");
      for (std::size_t i = 1; i < words.size(); ++i)
        mesh.face_vertices.push_back(parse_corner(words[i], mesh.vertices.size(), at));
      mesh.face_offsets.push_back(static_cast<int>(mesh.face_vertices.size()));
      mesh.face_line.push_back(at.line);
    } else if (std::ranges::find(skipped_keywords, keyword) == skipped_keywords.end()) {
      at.fail("unknown statement " + quoted(keyword) +
              ", expected one of Wavefront OBJ's such as v, f, vt or g");
    }
  }
  if (mesh.vertices.empty()) throw InputError(path, 0, "no vertices, expected lines such as 'v 0 0 0'");
  if (mesh.faces() == 0) throw InputError(path, 0, "no faces, expected lines such as 'f 1 2 3'");
  check_indices(mesh);
  return mesh;
}

}  // namespace springstab
