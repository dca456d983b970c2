// What the readers share whose files may hold a surface or a solid: vertices go by the numbers that the file
// gives them, and what it holds is known at its end.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "solvers/io/text_file.h"
#include "solvers/scene/mesh.h"
#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// A surface or a solid.
using AnyMesh = std::variant<Mesh, TetMesh>;

/// Collects a mesh; memory is in proportion to what was added. Vertices keep the order they are added in.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::string_view source);

  /// Fails at a number that was there before.
  void add_vertex(long long number, const Eigen::Vector3d& position, const Location& at);
  /// By the numbers of their corners, whose vertices may still come. A face of one or two corners is dropped.
  void add_tet(const std::array<long long, 4>& corners, const Location& at);
  void add_face(std::span<const long long> corners, const Location& at);
  /// A part of a surface that no reader can use, with what is to be said of it: an error unless the file
  /// turns out to hold a solid.
  void add_unusable_face(const Location& at, const std::string& what);

  /// The solid, if there are tetrahedra; then faces that bound none of them are noted and left out, as all
  /// others are. Otherwise the surface. Throws InputError at an element that names a vertex that is not
  /// there, and where there are no elements, with what was `expected` of the format.
  AnyMesh finish(const std::string& expected) &&;

 private:
  int index_of(long long number, const std::string& element, long line) const;
  TetMesh solid();
  Mesh surface();
  void note_loose_faces(TetMesh& mesh) const;

  std::string source_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<long> vertex_line_;
  std::unordered_map<long long, int> vertex_;
  std::vector<std::array<long long, 4>> tets_;
  std::vector<long> tet_line_;
  std::vector<long long> face_corners_;
  std::vector<int> face_offsets_{0};
  std::vector<long> face_line_;
  long short_faces_ = 0, first_short_face_ = 0;
  std::optional<std::pair<long, std::string>> unusable_;  // line and what is wrong
};

/// What a count of the file said against what stands there. Fails unless they are equal.
void check_count(const Location& at, const std::string& things, long long counted, long long announced);

/// A count in a file: a decimal integer from 0 to 2^31 - 1.
long long count_of(const Location& at, std::string_view word, const std::string& things);

}  // namespace springstab
