#include "solvers/io/tet_builder.h"

#include "solvers/io/input_error.h"

namespace springstab {

TetBuilder::TetBuilder(std::string_view source) { mesh_.source = source; }

void TetBuilder::add_vertex(long long number, const Eigen::Vector3d& position, const Location& at) {
  const auto [same, added] = vertex_.emplace(number, static_cast<int>(mesh_.vertices.size()));
  if (!added)
    at.fail("vertex " + std::to_string(number) + " is there a second time (it stands on line " +
            std::to_string(mesh_.vertex_line[same->second]) + " too), expected each number once");
  mesh_.vertices.push_back(position);
  mesh_.vertex_line.push_back(at.line);
}

void TetBuilder::add_tet(const std::array<long long, 4>& corners, const Location& at) {
  tets_.push_back(corners);
  mesh_.tet_line.push_back(at.line);
}

TetMesh TetBuilder::finish(const std::string& expected) {
  if (tets_.empty()) throw InputError(mesh_.source, 0, "no tetrahedra, expected " + expected);
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    mesh_.tets.emplace_back();
    for (int c = 0; c < 4; ++c) {
      const auto vertex = vertex_.find(tets_[t][c]);
      if (vertex == vertex_.end())
        throw InputError(mesh_.source, mesh_.tet_line[t],
                         "the tetrahedron has vertex " + std::to_string(tets_[t][c]) +
                             ", which is not there, expected one of the file's " +
                             std::to_string(mesh_.vertices.size()));
      mesh_.tets.back()[c] = vertex->second;
    }
  }
  return std::move(mesh_);
}

void check_count(const Location& at, const std::string& things, long long counted, long long announced) {
  if (counted != announced)
    at.fail(std::to_string(counted) + " " + things + ", expected the " + std::to_string(announced) +
            " that were announced");
}

long long count_of(const Location& at, std::string_view word, const std::string& things) {
  const long long count = at.integer(word);
  constexpr long long most = 2147483647;
  if (count < 0 || count > most)
    at.fail(quoted(word) + " " + things + ", expected a number from 0 to " + std::to_string(most));
  return count;
}

}  // namespace springstab
