// What a command works on: the INPUT of the command line, resolved. Either a scene (from a file, a mesh or a
// grid) or a system of matrices.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "analysis/method_limits.h"
#include "experiments/input/scene_description.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/mesh_repair.h"
#include "solvers/scene/scene.h"
#include "solvers/simulation.h"

namespace springstab {

/// INPUT as typed; empty strings were not given. Exactly one of file, grid and stiffness must be.
struct InputOptions {
  std::string file;               // SCENE.json or a mesh
  std::string grid;               // "NxM"
  std::optional<double> spacing;  // [m], with grid
  std::string material, pin;      // with grid or a mesh
  std::string stiffness, mass, damping_matrix;
  bool sum_duplicates = false;  // of these matrices' entries
};

/// A mesh file as it was, and what was mended to make a scene of it.
struct MeshFile {
  std::string path;
  bool solid;                             // of tetrahedra
  std::vector<Eigen::Vector3d> vertices;  // [m]
  MeshRepair repair;
  std::vector<FileNote> notes;  // on what its reader left out

  // of a cloth of triangles:
  std::optional<RestShape> rest_shape{};
  std::optional<TextureMap> texture_map{};
};

/// A system with its start and everything that limits and reports need to know about it.
class Subject {
 public:
  /// Throws InputError or std::invalid_argument when the input is unusable.
  /// Matrices must be symmetric unless `any_matrices` (prepare_nonsymmetric).
  explicit Subject(const InputOptions& options, bool any_matrices = false);
  explicit Subject(const SceneDescription& description);

  System& system();
  Scene* scene() { return scene_.get(); }               // null for matrices
  MatrixSystem* matrices() { return matrices_.get(); }  // null for scenes

  /// Faces for pictures, those of the mesh file (of a solid its surface) or of a grid's cells: numbers of
  /// vertices(); none for matrices.
  const std::vector<std::vector<int>>& faces() const { return faces_; }

  /// Of a scene, where the vertices of faces() are: the particles, or all vertices of the mesh file in its
  /// order. One that was merged is where its particle is; an unreferenced one stays where it started.
  std::vector<Eigen::Vector3d> vertices(const Vector& x) const;

  /// Where the scene is made of a mesh file.
  const std::optional<MeshFile>& mesh_file() const { return mesh_file_; }

  /// What a scene is made of; nothing for matrices.
  const std::optional<Material>& material() const { return material_; }

  /// The start: a scene's own; for matrices a random displacement of unit M-norm, at rest.
  State<Vector> initial_state(std::uint64_t seed);
  EnergyWatch energy_watch(const State<Vector>& start);

  /// K and M at a state (matrices are the same at all), D where it is of kind `general`, and what kind of
  /// damping there is.
  StructuralMatrices structure(const State<Vector>& state);
  DampingModel damping();
  /// Of a scene of springs alone: matrices that no pose exceeds (solvers/scene/every_pose.h).
  std::optional<StructuralMatrices> every_pose() const;

  /// Leaves alpha to the design, as "alpha": "designed" does. Throws InputError for matrices.
  void design_damping();
  /// Fixes alpha where it was left to the design.
  void set_alpha(double alpha);

 private:
  void build_scene(const SceneDescription& description);
  void build_surface(Mesh original, const SceneDescription& description);
  void build_solid(TetMesh original, const SceneDescription& description);
  template <class Cloth>
  void place(const Cloth& cloth, const SceneDescription& description, const Grid* grid,
             const std::string& source);
  void build_matrices(const InputOptions& options, bool any_matrices);

  std::unique_ptr<Scene> scene_;
  std::unique_ptr<MatrixSystem> matrices_;
  std::vector<std::vector<int>> faces_;
  std::optional<MeshFile> mesh_file_;
  std::optional<SpringNet> net_;  // of a scene of springs
  std::vector<int> pinned_;
  std::optional<Material> material_;
  RayleighDescription rayleigh_;
  InitialDescription initial_;
};

/// Whether a file is a scene, by its suffix.
bool is_scene_file(const std::string& path);

/// "NxM" as a grid. Throws InputError(source, ...).
Grid parse_grid(const std::string& text, const std::string& source);

}  // namespace springstab
