// Materials known by name.
#include "experiments/command/words.h"
#include "experiments/inputs/scene_description.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/text_file.h"

namespace springstab {
bool is_solid(const Geometry& geometry) {
  const std::string* file = std::get_if<std::string>(&geometry);
  return file && holds_tetrahedra(*file);
}

Material named_material(const std::string& name, bool solid, const std::string& source, long line) {
  if (solid) {
    if (name == "default") return SolidMaterial{};
    if (name == "soft") return SolidMaterial{.stiffness = {100, 100}};
    if (name == "stiff") return SolidMaterial{.stiffness = {1e5, 1e5}};
    throw InputError(source, line,
                     "the material " + springstab::quoted(name) + " of a mesh of tetrahedra, " +
                         expected_one_of(name, {"default", "soft", "stiff"}));
  }
  if (name == "default") return SpringMaterial{};
  if (name == "soft") return SpringMaterial{.stiffness = {20, 10, 2}};
  if (name == "stiff") return SpringMaterial{.stiffness = {20000, 10000, 200}};
  if (name == "baraff-witkin") return ClothMaterial{};
  throw InputError(source, line,
                   "unknown material " + springstab::quoted(name) + ", " +
                       expected_one_of(name, {"default", "soft", "stiff", "baraff-witkin"}));
}

}  // namespace springstab
