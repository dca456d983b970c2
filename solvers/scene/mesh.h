// A polygon mesh as its file gave it: the geometry of a cloth at rest, before any physics.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace springstab {

/// What a reader left out of a file, for people to know.
struct FileNote {
  long line;  // of the first such thing
  std::string text;
};

/// What an OBJ file says of its faces beside their corners.
struct FaceAttributes {
  /// A statement of a group (`g`), object (`o`), material (`mtllib`, `usemtl`) or smoothing group (`s`),
  /// which stands before this face and holds from it on.
  struct Statement {
    int face;
    std::string keyword, words;
  };
  std::vector<Statement> statements;
  std::vector<Eigen::Vector2d> textures;  // texture coordinates, as the file numbers them
  std::vector<int> corner_textures;       // the number of each corner's from 0, or -1: one per face_vertices
};

/// Polygons over vertices. Face f has the vertices `face(f)`, in order around it, indices from 0.
/// The source lines let an error that is found later (a zero-length edge, say) still name its line.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;  // [m]
  std::vector<int> face_offsets{0};       // size faces() + 1, into face_vertices
  std::vector<int> face_vertices;
  std::string source;             // the file's name, for messages
  std::vector<long> vertex_line;  // one per vertex
  std::vector<long> face_line;    // one per face

  /// Texture coordinates of the corners: one per entry of face_vertices, or none at all where the file leaves
  /// a corner without. A vertex may have several, at a seam.
  std::vector<Eigen::Vector2d> corner_uv{};

  FaceAttributes attributes{};  // of an OBJ file

  std::vector<FileNote> notes{};

  int faces() const { return static_cast<int>(face_offsets.size()) - 1; }
  std::span<const int> face(int f) const {
    return {face_vertices.data() + face_offsets[f], face_vertices.data() + face_offsets[f + 1]};
  }
};

/// The most faces at an edge, for each two of them are joined: what a small file describes stays small.
inline constexpr int most_faces_at_edge = 100;

/// Throws InputError, with the mesh's file and line, unless there are faces, every coordinate is finite,
/// every face has three or more distinct corners that exist, and every vertex belongs to a face.
void check(const Mesh& mesh);

/// Throw an InputError about a face or a vertex, with the mesh's file and, where it is known, the line.
[[noreturn]] void fail_at_face(const Mesh& mesh, int face, const std::string& what);
[[noreturn]] void fail_at_vertex(const Mesh& mesh, int vertex, const std::string& what);

}  // namespace springstab
