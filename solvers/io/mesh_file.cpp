#include "solvers/io/mesh_file.h"

#include <filesystem>
#include <limits>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/obj.h"
#include "solvers/io/text_file.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"

namespace springstab {
namespace {}  // namespace

AnyMesh read_mesh(const std::string& path) {
  const std::string suffix = lowercase(std::filesystem::path(path).extension().string());
  if (suffix != "" && suffix != ".obj" && suffix != ".msh" && suffix != ".veg" && suffix != ".vtk")
    throw InputError(
        path, 0,
        "is of no known kind, expected a suffix: .json for a scene, .obj for a surface, .veg for "
        "tetrahedra, .msh or .vtk for either");
  const std::string text = read_text_file(path);
  if (suffix == ".msh") return parse_gmsh(path, text);
  if (suffix == ".vtk") return parse_vtk(path, text);
  if (suffix == ".veg") return parse_vega(path, text);
  return parse_obj(path, text);
}

bool holds_tetrahedra(const std::string& path) {
  const std::string suffix = lowercase(std::filesystem::path(path).extension().string());
  if (suffix != ".msh" && suffix != ".vtk") return suffix == ".veg";
  if (!std::filesystem::is_regular_file(path)) return true;  // a pipe can be read but once
  try {
    return std::holds_alternative<TetMesh>(read_mesh(path));
  } catch (const InputError&) {
    return true;
  }
}

}  // namespace springstab
