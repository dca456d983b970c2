#include "solvers/io/tet_file.h"

#include <filesystem>
#include <limits>

#include "solvers/io/gmsh.h"
#include "solvers/io/input_error.h"
#include "solvers/io/text_file.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"

namespace springstab {
namespace {

using Parse = TetMesh (*)(const std::string& source, std::string_view text);

Parse parser_of(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  for (char& c : suffix)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (suffix == ".msh") return parse_gmsh;
  if (suffix == ".veg") return parse_vega;
  if (suffix == ".vtk") return parse_vtk;
  return nullptr;
}

}  // namespace

bool is_tet_file(const std::string& path) { return parser_of(path) != nullptr; }

TetMesh read_tets(const std::string& path) {
  const Parse parse = parser_of(path);
  if (!parse) throw InputError(path, 0, "is of no known kind, expected a suffix .msh, .veg or .vtk");
  const std::string text = read_text_file(path);
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError(path, 0, "the file has more than 2^31 - 1 bytes, expected a smaller mesh");
  return parse(path, text);
}

}  // namespace springstab
