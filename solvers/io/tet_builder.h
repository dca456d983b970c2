// What the readers of tetrahedral meshes share: vertices go by the numbers that the file gives them.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>

#include "solvers/io/text_file.h"
#include "solvers/scene/tet_mesh.h"

namespace springstab {

/// Collects a mesh; memory is in proportion to what was added. Vertices keep the order they are added in.
class TetBuilder {
 public:
  explicit TetBuilder(std::string_view source);

  /// Fails at a number that was there before.
  void add_vertex(long long number, const Eigen::Vector3d& position, const Location& at);
  /// By the numbers of its corners, whose vertices may still come.
  void add_tet(const std::array<long long, 4>& corners, const Location& at);

  /// Throws InputError at a tetrahedron that names a vertex that is not there, and where there are no
  /// tetrahedra, with what was `expected` of the format.
  TetMesh finish(const std::string& expected);

 private:
  TetMesh mesh_;
  std::unordered_map<long long, int> vertex_;
  std::vector<std::array<long long, 4>> tets_;
};

/// What a count of the file said against what stands there. Fails unless they are equal.
void check_count(const Location& at, const std::string& things, long long counted, long long announced);

/// A count in a file: a decimal integer from 0 to 2^31 - 1.
long long count_of(const Location& at, std::string_view word, const std::string& things);

}  // namespace springstab
