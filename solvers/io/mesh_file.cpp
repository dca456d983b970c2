#include "solvers/io/mesh_file.h"

#include <algorithm>
#include <filesystem>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/obj.h"
#include "solvers/io/off.h"
#include "solvers/io/ply.h"
#include "solvers/io/stl.h"
#include "solvers/io/text_file.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"
#include "solvers/io/vtk_xml.h"

namespace springstab {
namespace {

enum class Holds { surface, solid, either };

struct MeshFormat {
  std::string_view suffix;
  AnyMesh (*parse)(const std::string& source, std::string_view text);
  bool (*is_binary)(std::string_view beginning);
  Holds holds;
};

template <auto parse_it>
AnyMesh parse_any(const std::string& source, std::string_view text) {
  return parse_it(source, text);
}

bool is_text(std::string_view) { return false; }

const MeshFormat* mesh_format(const std::string& path) {
  using enum Holds;
  static constexpr MeshFormat formats[] = {{"", parse_any<parse_obj>, is_text, surface},
                                           {".obj", parse_any<parse_obj>, is_text, surface},
                                           {".off", parse_any<parse_off>, is_text, surface},
                                           {".ply", parse_any<parse_ply>, is_binary_ply, surface},
                                           {".stl", parse_any<parse_stl>, is_binary_stl, surface},
                                           {".msh", parse_gmsh, is_binary_gmsh, either},
                                           {".veg", parse_any<parse_vega>, is_text, solid},
                                           {".vtk", parse_vtk, is_binary_vtk, either},
                                           {".vtp", parse_vtk_xml, is_xml, surface},
                                           {".vtu", parse_vtk_xml, is_xml, either}};
  const std::string suffix = lowercase(std::filesystem::path(path).extension().string());
  const auto* const found = std::ranges::find(formats, suffix, &MeshFormat::suffix);
  return found == std::end(formats) ? nullptr : found;
}

}  // namespace

AnyMesh read_mesh(const std::string& path) {
  const MeshFormat* const format = mesh_format(path);
  if (!format)
    throw InputError(path, 0,
                     "is of no known kind, expected a suffix: .json for a scene, .obj, .off, .ply, .stl or "
                     ".vtp for a surface, "
                     ".veg for tetrahedra, .msh, .vtk or .vtu for either");
  return format->parse(path, read_file(path, format->is_binary));
}

bool holds_tetrahedra(const std::string& path) {
  const MeshFormat* const format = mesh_format(path);
  if (!format || format->holds != Holds::either) return format && format->holds == Holds::solid;
  if (!std::filesystem::is_regular_file(path)) return true;  // a pipe can be read but once
  try {
    return std::holds_alternative<TetMesh>(read_mesh(path));
  } catch (const InputError&) {
    return true;
  }
}

}  // namespace springstab
