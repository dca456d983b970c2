#include "solvers/io/mesh_builder.h"

#include <algorithm>
#include <set>
#include <utility>

#include "solvers/io/input_error.h"

namespace springstab {

MeshBuilder::MeshBuilder(std::string_view source) : source_(source) {}

void MeshBuilder::add_vertex(long long number, const Eigen::Vector3d& position, const Location& at) {
  const auto [same, added] = vertex_.emplace(number, static_cast<int>(vertices_.size()));
  if (!added)
    at.fail("vertex " + std::to_string(number) + " is there a second time (it stands on " +
            place_name(vertex_line_[same->second]) + " too), expected each number once");
  vertices_.push_back(position);
  vertex_line_.push_back(at.line);
}

void MeshBuilder::add_tet(const std::array<long long, 4>& corners, const Location& at) {
  tets_.push_back(corners);
  tet_line_.push_back(at.line);
}

void MeshBuilder::add_face(std::span<const long long> corners, const Location& at) {
  if (corners.size() < 3) {
    if (short_faces_++ == 0) first_short_face_ = at.line;
    return;
  }
  face_corners_.insert(face_corners_.end(), corners.begin(), corners.end());
  face_offsets_.push_back(static_cast<int>(face_corners_.size()));
  face_line_.push_back(at.line);
}

void MeshBuilder::add_unusable_face(const Location& at, const std::string& what) {
  if (!unusable_) unusable_.emplace(at.line, what);
}

AnyMesh MeshBuilder::finish(const std::string& expected) && {
  if (!tets_.empty()) return solid();
  if (unusable_) throw InputError(source_, unusable_->first, unusable_->second);
  if (face_line_.empty())
    throw InputError(source_, 0, "neither tetrahedra nor faces of a surface, expected " + expected);
  return surface();
}

int MeshBuilder::index_of(long long number, const std::string& element, long line) const {
  const auto vertex = vertex_.find(number);
  if (vertex == vertex_.end())
    throw InputError(source_, line,
                     "the " + element + " has vertex " + std::to_string(number) +
                         ", which is not there, expected one of the file's " +
                         std::to_string(vertices_.size()));
  return vertex->second;
}

TetMesh MeshBuilder::solid() {
  TetMesh mesh;
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    mesh.tets.emplace_back();
    for (int c = 0; c < 4; ++c) mesh.tets.back()[c] = index_of(tets_[t][c], "tetrahedron", tet_line_[t]);
  }
  mesh.source = source_;
  mesh.vertices = std::move(vertices_);
  mesh.vertex_line = std::move(vertex_line_);
  mesh.tet_line = std::move(tet_line_);
  note_loose_faces(mesh);
  return mesh;
}

void MeshBuilder::note_loose_faces(TetMesh& mesh) const {
  if (face_line_.empty()) return;
  std::set<std::array<long long, 3>> sides;
  for (const auto& tet : tets_)
    for (const auto& side : outward_faces) {
      std::array<long long, 3> corners{tet[side[0]], tet[side[1]], tet[side[2]]};
      std::ranges::sort(corners);
      sides.insert(corners);
    }
  FileNote note{0, ""};
  int loose = 0;
  for (std::size_t f = 0; f < face_line_.size(); ++f) {
    std::vector<long long> corners(face_corners_.begin() + face_offsets_[f],
                                   face_corners_.begin() + face_offsets_[f + 1]);
    std::ranges::sort(corners);
    if (corners.size() == 3 && sides.contains({corners[0], corners[1], corners[2]})) continue;
    if (loose++ == 0) note.line = face_line_[f];
  }
  note.text = loose == 1 ? "a face that bounds no tetrahedron is left out"
                         : std::to_string(loose) + " faces that bound no tetrahedron are left out";
  if (loose > 0) mesh.notes.push_back(note);
}

Mesh MeshBuilder::surface() {
  Mesh mesh;
  for (std::size_t f = 0; f < face_line_.size(); ++f)
    for (int c = face_offsets_[f]; c < face_offsets_[f + 1]; ++c)
      mesh.face_vertices.push_back(index_of(face_corners_[c], "face", face_line_[f]));
  mesh.face_offsets = std::move(face_offsets_);
  mesh.source = source_;
  mesh.vertices = std::move(vertices_);
  mesh.vertex_line = std::move(vertex_line_);
  mesh.face_line = std::move(face_line_);
  if (short_faces_ > 0)
    mesh.notes.push_back(
        {first_short_face_, short_faces_ == 1
                                ? "dropped a face of one or two corners"
                                : std::to_string(short_faces_) + " faces of one or two corners are dropped"});
  return mesh;
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
