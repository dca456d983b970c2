#include "solvers/io/vtk_cells.h"

#include <array>

namespace springstab {
namespace {

/// Types of cells: nothing, points and lines, of any order; and curved surfaces, which have points within
/// their edges.
constexpr auto vtk_skipped = std::to_array<long long>({0, 1, 2, 3, 4, 21, 35, 68, 75});
constexpr auto vtk_curved_surfaces = std::to_array<long long>({22, 23, 28, 30, 34, 36, 69, 70, 76, 77});

}  // namespace

void check_vtk_cell(long long type, long long corners, const Location& type_at, const Location& cell_at) {
  const std::string kind = "a cell of type " + std::to_string(type);
  if (!is_among(vtk_skipped, type) && !is_among(vtk_curved_surfaces, type) &&
      (type < vtk_triangle || type > vtk_tetrahedron))
    type_at.fail(kind + ", expected triangles to quadrangles or tetrahedra (types 5 to 10)");
  const int needed = type == vtk_triangle ? 3 : type >= vtk_pixel && type <= vtk_tetrahedron ? 4 : 0;
  if (needed > 0 && corners != needed)
    cell_at.fail(kind + " has " + std::to_string(corners) + " corners, expected " + std::to_string(needed));
}

void add_vtk_cell(MeshBuilder& builder, long long type, std::span<const long long> c, const Location& at) {
  if (type == vtk_tetrahedron) {
    builder.add_tet({c[0], c[1], c[2], c[3]}, at);
  } else if (type == vtk_strip) {  // a triangle of each corner and the two before, every other one turned
    for (std::size_t k = 2; k < c.size(); ++k)
      builder.add_face(std::array{c[k - 2 + k % 2], c[k - 1 - k % 2], c[k]}, at);
  } else if (type == vtk_pixel) {  // by rows
    builder.add_face(std::array{c[0], c[1], c[3], c[2]}, at);
  } else if (type == vtk_triangle || type == vtk_polygon || type == vtk_quadrangle) {
    builder.add_face(c, at);
  } else if (is_among(vtk_curved_surfaces, type)) {
    builder.add_unusable_face(at, "a cell of type " + std::to_string(type) +
                                      ", which has points between its corners, expected flat ones "
                                      "(types 5 to 9)");
  }
}

}  // namespace springstab
