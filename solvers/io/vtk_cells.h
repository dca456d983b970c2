// The cells of VTK's files, of either family, as parts of a mesh (VTK File Formats, "Linear cell types").
#pragma once

#include <span>

#include "solvers/io/mesh_builder.h"

namespace springstab {

/// Types of cells.
enum VtkCell {
  vtk_poly_vertex = 2,
  vtk_poly_line = 4,
  vtk_triangle,
  vtk_strip,
  vtk_polygon,
  vtk_pixel,
  vtk_quadrangle,
  vtk_tetrahedron
};

/// Fails at `type_at` for solid cells other than tetrahedra, at `cell_at` for a wrong number of corners.
void check_vtk_cell(long long type, long long corners, const Location& type_at, const Location& cell_at);

/// Adds a cell that was checked, with these numbers of vertices; points and lines are skipped.
void add_vtk_cell(MeshBuilder& builder, long long type, std::span<const long long> corners,
                  const Location& at);

}  // namespace springstab
