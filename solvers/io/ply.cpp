#include "solvers/io/ply.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/io/mesh_builder.h"
#include "solvers/io/ply_header.h"

namespace springstab {
namespace {

/// What programs call texture coordinates.
constexpr std::array<std::array<std::string_view, 2>, 4> ply_textures{
    {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};

class PlyReader {
 public:
  PlyReader(const std::string& source, std::string_view text) : numbers_(source, text), builder_(source) {}

  Mesh read() {
    for (const PlyElement& element : numbers_.elements()) {
      numbers_.expect_room(element);
      if (element.name == "vertex") choose_properties(element);
      for (long long i = 0; i < element.count; ++i) record(element);
      if (element.name != "vertex" && element.name != "face" && element.count > 0)
        notes_.push_back(
            {element.at.line, "the element " + springstab::quoted(element.name) + " is not used"});
    }
    numbers_.finish();
    Mesh mesh = std::get<Mesh>(std::move(builder_).finish("an element face with a list vertex_indices"));
    mesh.notes.insert(mesh.notes.end(), notes_.begin(), notes_.end());
    use_textures(mesh);
    return mesh;
  }

 private:
  static constexpr std::size_t x = 0, y = 1, z = 2, s = 3, t = 4, unused = 5;

  static std::size_t place_of_property(const PlyElement& element, std::string_view name) {
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].name == name && !element.properties[i].count) return i;
    return element.properties.size();
  }

  /// Which of a vertex's properties are x, y, z, s and t.
  void choose_properties(const PlyElement& vertex) {
    use_.assign(vertex.properties.size(), std::size_t{unused});
    const auto use = [&](std::string_view name, std::size_t as) {
      const std::size_t place = place_of_property(vertex, name);
      if (place < use_.size()) use_[place] = as;
      return place < use_.size();
    };
    if (!use("x", x) || !use("y", y) || !use("z", z))
      vertex.at.fail("the vertices lack one of the properties x, y and z, expected all three");
    for (const auto& [first, second] : ply_textures)
      if (place_of_property(vertex, first) < use_.size() && use(second, t)) {
        use(first, s);
        textured_ = true;
        return;
      }
  }

  void record(const PlyElement& element) {
    const bool vertex = element.name == "vertex", face = element.name == "face";
    const Location at = numbers_.begin(element);
    std::array<double, 6> numbers{};
    corners_.clear();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.count) {
        numbers[vertex ? use_[p] : std::size_t{unused}] = numbers_.next(property.type, property.name);
        continue;
      }
      const bool corners = face && (property.name == "vertex_indices" || property.name == "vertex_index");
      for (long long left = numbers_.length(property); left > 0; --left) {
        const double number = numbers_.next(property.type, property.name);
        if (corners) corners_.push_back(corner(number, at));
      }
    }
    numbers_.end(element);
    if (face) builder_.add_face(corners_, at);
    if (vertex) add_vertex(numbers, at);
  }

  static long long corner(double number, const Location& at) {
    constexpr double most = 4294967295;
    if (!(std::abs(number) <= most) || number != std::floor(number))
      at.fail("a face has a corner that is no integer, expected numbers of vertices");
    return static_cast<long long>(number);
  }

  void add_vertex(const std::array<double, 6>& numbers, const Location& at) {
    for (const std::size_t i : {x, y, z})
      if (!std::isfinite(numbers[i]))
        at.fail("a coordinate of the vertex is not finite, expected finite numbers");
    builder_.add_vertex(vertices_++, {numbers[x], numbers[y], numbers[z]}, at);
    if (textured_) textures_.emplace_back(numbers[s], numbers[t]);
    if (textured_ && !textures_.back().allFinite() && unusable_++ == 0) first_unusable_ = at.line;
  }

  void use_textures(Mesh& mesh) const {
    if (unusable_ > 0)
      mesh.notes.push_back({first_unusable_, "texture coordinates are no numbers, and none are used"});
    if (!textured_ || unusable_ > 0) return;
    for (const int v : mesh.face_vertices) mesh.corner_uv.push_back(textures_[v]);
  }

  PlyNumbers numbers_;
  MeshBuilder builder_;
  std::vector<std::size_t> use_;  // of a vertex's properties
  std::vector<long long> corners_;
  long long vertices_ = 0;
  bool textured_ = false;
  std::vector<Eigen::Vector2d> textures_;  // of the vertices
  long unusable_ = 0, first_unusable_ = 0;
  std::vector<FileNote> notes_;
};

}  // namespace

bool is_binary_ply(std::string_view beginning) {
  return beginning.starts_with("ply") && beginning.substr(0, 1024).find("format binary_") != beginning.npos;
}

Mesh parse_ply(const std::string& source, std::string_view text) { return PlyReader(source, text).read(); }

}  // namespace springstab
