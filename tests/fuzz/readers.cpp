#include "tests/fuzz/readers.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "experiments/inputs/scene_description.h"
#include "solvers/io/abaqus.h"
#include "solvers/io/gmsh.h"
#include "solvers/io/harwell_boeing.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_market.h"
#include "solvers/io/mesh_builder.h"
#include "solvers/io/npz.h"
#include "solvers/io/obj.h"
#include "solvers/io/off.h"
#include "solvers/io/petsc.h"
#include "solvers/io/ply.h"
#include "solvers/io/stl.h"
#include "solvers/io/vega.h"
#include "solvers/io/vtk.h"
#include "solvers/io/vtk_xml.h"

namespace springstab::test {
namespace {

const std::string source = "file";

void require(bool holds, const std::string& law) {
  if (!holds) throw std::logic_error(law);
}

bool all_in_range(const std::vector<int>& indices, std::size_t count) {
  return std::ranges::all_of(indices, [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < count; });
}

void check_matrix(const Eigen::SparseMatrix<double>& matrix) {
  require(matrix.rows() > 0 && matrix.cols() > 0 && matrix.isCompressed(), "a matrix has a size");
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    Eigen::Index above = -1;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, column); entry; ++entry) {
      require(std::isfinite(entry.value()), "entries are finite");
      require(entry.row() > above && entry.row() < matrix.rows(), "rows ascend and exist");
      above = entry.row();
    }
  }
}

void check_notes(const std::vector<FileNote>& notes) {
  for (const FileNote& note : notes)
    require(note.line != 0 && !note.text.empty() &&
                std::ranges::none_of(note.text, [](unsigned char c) { return c < ' ' || c == 127; }),
            "a note has a line and is printable");
}

void check_mesh(const Mesh& mesh) {
  require(!mesh.vertices.empty() && mesh.faces() > 0, "a mesh has vertices and faces");
  for (const Eigen::Vector3d& vertex : mesh.vertices) require(vertex.allFinite(), "vertices are finite");
  for (const Eigen::Vector2d& uv : mesh.corner_uv) require(uv.allFinite(), "coordinates are finite");
  require(mesh.corner_uv.empty() || mesh.corner_uv.size() == mesh.face_vertices.size(), "one for a corner");
  require(mesh.vertex_line.size() == mesh.vertices.size(), "each vertex has a line");
  require(static_cast<int>(mesh.face_line.size()) == mesh.faces(), "each face has a line");
  check_notes(mesh.notes);
  require(mesh.face_offsets.front() == 0 && std::ranges::is_sorted(mesh.face_offsets), "offsets ascend");
  require(mesh.face_offsets.back() == static_cast<int>(mesh.face_vertices.size()), "corners have a face");
  require(all_in_range(mesh.face_vertices, mesh.vertices.size()), "corners are vertices");
}

void check_tets(const TetMesh& mesh) {
  require(!mesh.vertices.empty() && !mesh.tets.empty(), "a mesh has vertices and tetrahedra");
  for (const Eigen::Vector3d& vertex : mesh.vertices) require(vertex.allFinite(), "vertices are finite");
  require(mesh.vertex_line.size() == mesh.vertices.size(), "each vertex has a line");
  require(mesh.tet_line.size() == mesh.tets.size(), "each tetrahedron has a line");
  check_notes(mesh.notes);
  for (const auto& tet : mesh.tets)
    require(all_in_range({tet.begin(), tet.end()}, mesh.vertices.size()), "corners are vertices");
}

void check_any(const AnyMesh& mesh) {
  if (const TetMesh* solid = std::get_if<TetMesh>(&mesh)) return check_tets(*solid);
  check_mesh(std::get<Mesh>(mesh));
}

void check_scene(const SceneDescription& scene) {
  if (const Grid* grid = std::get_if<Grid>(&scene.geometry))
    require(grid->rows > 0 && grid->columns > 0 && grid->rows <= max_particles / grid->columns &&
                grid->spacing > 0 && std::isfinite(grid->spacing),
            "a grid has particles apart from each other");
  else
    require(!std::get<std::string>(scene.geometry).empty(), "a mesh has a path");
  int before = -1;
  for (const auto& [first, last] : scene.pins.ranges) {
    require(before < first && first <= last && last < max_particles, "pins ascend and are particles");
    before = last;
  }
  const auto& [d0, alpha] = scene.damping;
  require(
      scene.gravity.allFinite() && scene.initial.stretch.allFinite() && scene.initial.velocity.allFinite(),
      "vectors are finite");
  require(d0 >= 0 && alpha.value_or(0) >= 0 && std::isfinite(d0 + alpha.value_or(0)), "damping is finite");
}

/// "file: ..." or "file:LINE: ..." with a line of the text; printable, and it says what was expected.
void check_refusal(std::string_view message, std::string_view text) {
  const std::string quoted = " in the message '" + std::string(message) + "'";
  require(message.find("expected") != message.npos, "what was expected is missing" + quoted);
  require(std::ranges::none_of(message, [](unsigned char c) { return c < ' ' || c == 127; }),
          "a character that is not printable" + quoted);
  require(message.size() < 500, "a long story" + quoted);
  require(message.starts_with(source + ':'), "the file is missing" + quoted);
  message.remove_prefix(source.size() + 1);
  if (message.starts_with(' ')) return;
  long line = 0;
  const auto end = std::from_chars(message.data(), message.data() + message.size(), line).ptr;
  require(std::string_view(end, message.data() + message.size()).starts_with(": "), "no line" + quoted);
  require(line >= 1 && line <= 1 + std::ranges::count(text, '\n') + std::ranges::count(text, '\r'),
          "no such line" + quoted);
}

}  // namespace

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{
      {"abaqus", [](std::string_view text) { check_matrix(parse_abaqus(source, text)); }},
      {"gmsh", [](std::string_view text) { check_any(parse_gmsh(source, text)); }},
      {"harwell_boeing", [](std::string_view text) { check_matrix(parse_harwell_boeing(source, text)); }},
      {"matrix_market", [](std::string_view text) { check_matrix(parse_matrix_market(source, text)); }},
      {"npz", [](std::string_view text) { check_matrix(parse_npz(source, text)); }},
      {"obj", [](std::string_view text) { check_mesh(parse_obj(source, text)); }},
      {"off", [](std::string_view text) { check_mesh(parse_off(source, text)); }},
      {"petsc", [](std::string_view text) { check_matrix(parse_petsc(source, text)); }},
      {"ply", [](std::string_view text) { check_mesh(parse_ply(source, text)); }},
      {"scene", [](std::string_view text) { check_scene(parse_scene(source, text)); }},
      {"stl", [](std::string_view text) { check_mesh(parse_stl(source, text)); }},
      {"vega", [](std::string_view text) { check_tets(parse_vega(source, text)); }},
      {"vtk", [](std::string_view text) { check_any(parse_vtk(source, text)); }},
      {"vtk_xml", [](std::string_view text) { check_any(parse_vtk_xml(source, text)); }},
  };
  return all;
}

bool reads(const Reader& reader, std::string_view text) {
  try {
    reader.read(text);
  } catch (const InputError& error) {
    check_refusal(error.what(), text);
    return false;
  }
  return true;
}

}  // namespace springstab::test
