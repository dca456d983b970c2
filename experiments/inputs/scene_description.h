// A scene as the user describes it, from a JSON file or from command-line options:
// plain data, with the defaults of the command-line contract, before anything is built.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "solvers/contact/contact.h"
#include "solvers/scene/spring_cloth.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab {

/// The particles from first to last, both among them.
struct Range {
  int first, last;
  bool operator==(const Range&) const = default;
};

/// Which particles are held fast.
struct Pins {
  enum class Kind { none, first_row, corners, indices, group, object, box };
  Kind kind = Kind::none;
  std::vector<Range> ranges;  // for Kind::indices, from 0, ascending, none overlaps another
  std::string source;         // where it was written, for messages ("--pin" or the scene file)
  long line = 0;
  std::string name{};         // for Kind::group and Kind::object, of an OBJ file
  Eigen::AlignedBox3d box{};  // for Kind::box: all that rests in it or on it [m]
};

/// Rayleigh damping D = d0 M + alpha K; no value means that alpha is to be designed with the step.
struct RayleighDescription {
  double d0 = 0;                    // [1/s]
  std::optional<double> alpha = 0;  // [s]
};

/// How the scene starts: rest positions times `stretch` (per axis, about the origin), one velocity for all
/// free particles.
struct InitialDescription {
  Eigen::Vector3d stretch{1, 1, 1};
  Eigen::Vector3d velocity{0, 0, 0};  // [m/s]
};

/// A grid, or the path of a mesh file.
using Geometry = std::variant<Grid, std::string>;

/// Springs, Baraff's and Witkin's triangles, or a solid of tetrahedra.
using Material = std::variant<SpringMaterial, ClothMaterial, SolidMaterial>;

/// Where an obstacle was written, and the how manyth it is there.
struct ObstaclePlace {
  long line = 0;
  int number = 0;
};

/// A mesh that stands in the way.
struct MeshObstacleDescription {
  std::string path;
  Eigen::Vector3d velocity;  // [m/s]
  ObstaclePlace place;
};

/// Contact as it was written, and where, for messages. Its meshes are yet to be read.
struct ContactDescription {
  Contact contact;
  std::string source;
  long line = 0, thickness_line = 0, self_line = 0;
  std::vector<ObstaclePlace> places{};  // of the contact's obstacles
  std::vector<MeshObstacleDescription> meshes{};
};

struct SceneDescription {
  Geometry geometry;
  Material material;
  Pins pins;
  Eigen::Vector3d gravity{0, -9.81, 0};  // [m/s²]
  RayleighDescription damping;
  InitialDescription initial;
  double scale = 1;                    // of the geometry: what its numbers are [m]
  std::optional<double> total_mass{};  // to which all masses are scaled [kg]
  std::optional<ContactDescription> contact{};
};

/// The same particles by ascending ranges that are apart from each other.
std::vector<Range> merged(std::vector<Range> ranges);

/// "none", "first-row", "corners", "0,5-9", "group:NAME", "object:NAME" or "box:x0:x1,y0:y1,z0:z1" [m], where
/// a bound that is left out is infinite. Throws InputError(source, line, ...) for anything else.
Pins parse_pins(const std::string& text, const std::string& source, long line);

/// Whether the geometry is a file of tetrahedra (holds_tetrahedra of solvers/io/mesh_file.h).
bool is_solid(const Geometry& geometry);

/// The materials known by name, of a solid or of a surface. Throws InputError(source, line, ...) naming the
/// nearest known one.
Material named_material(const std::string& name, bool solid, const std::string& source, long line);

/// Parses a scene (JSON; the schema stands in docs/scenes.md). Paths in it are relative to the file `source`;
/// only .msh and .vtk are opened, to see whether they hold a solid. Throws InputError with the line for
/// syntax errors, unknown, duplicate or missing keys, wrong types, values out of range.
SceneDescription parse_scene(const std::string& source, std::string_view text);

/// The same of a file.
SceneDescription read_scene_file(const std::string& path);

}  // namespace springstab
