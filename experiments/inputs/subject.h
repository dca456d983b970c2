// What a command works on: the INPUT of the command line, resolved. Either a scene (from a file, a mesh or a
// grid) or a system of matrices.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/limits/penalty_contact.h"
#include "analysis/limits/stiffest_motion.h"
#include "analysis/model.h"
#include "experiments/inputs/contact_input.h"
#include "experiments/inputs/input_options.h"
#include "experiments/inputs/mesh_input.h"
#include "solvers/contact/contact_filter.h"
#include "solvers/contact/surface_touches.h"

namespace springstab {

/// How large a scene is.
struct SceneSize {
  Eigen::Vector3d extent;                 // of the box around all particles at rest [m]
  double mass;                            // pinned particles' too [kg]
  long springs, triangles, hinges;        // that were made
  std::optional<double> shortest_edge{};  // [m]
};

/// A model, and where it came from.
class Subject : public Model {
 public:
  /// Throws InputError or std::invalid_argument when the input is unusable.
  /// Matrices must be symmetric unless `any_matrices` (prepare_nonsymmetric).
  explicit Subject(const InputOptions& options, bool any_matrices = false);
  explicit Subject(const SceneDescription& description);
  /// Matrices, of which an empty one is the identity (mass) or zero; `implicit_damping` as prepare() has it.
  /// Throws std::invalid_argument.
  Subject(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseMatrix& damping,
          const SparseMatrix& implicit_damping, const RayleighDamping& rayleigh, bool any_matrices);

  /// Faces for pictures, those of the mesh file (of a solid its surface) or of a grid's cells: numbers of
  /// vertices(); none for matrices.
  const Faces& faces() const;

  /// Of a scene, where the vertices of faces() are: the particles, or all vertices of the mesh file in its
  /// order. One that was merged is where its particle is; an unreferenced one stays where it started.
  std::vector<Eigen::Vector3d> vertices(const Vector& x) const;

  /// Where the scene is made of a mesh file.
  const std::optional<MeshFile>& mesh_file() const { return mesh_file_; }

  /// What a scene is made of; nothing for matrices.
  const std::optional<Material>& material() const { return material_; }

  /// Of a scene; nothing for matrices.
  const std::optional<SceneSize>& scene_size() const { return size_; }

  /// Where a scene's particles meet obstacles.
  const std::optional<Contact>& contact() const { return contact_; }
  /// What of the cloth meets itself and meshes, and how that is named.
  std::pair<ClothSurface, SurfaceNames> contact_surface() const;
  /// What is to be known of obstacles.
  const std::vector<std::string>& contact_notes() const { return contact_notes_; }
  /// What that takes between steps; null where it takes nothing.
  std::unique_ptr<ContactFilter> contact_filter() const;
  /// Whether springs act between surfaces, of which it is not known before how many there are at a particle.
  bool counts_contacts() const { return touches_ != nullptr; }
  /// Then how many are to be planned for at x (solvers/contact/surface_penalty.h).
  long contacts(const Vector& x) const;
  /// Of a penalty, what it adds to K and D at most: with all planes and balls there are, and of surfaces with
  /// so many contacts at a particle.
  std::optional<ContactBound> contact_bound(long contacts = 1) const;

  /// Whether a grid's diagonals alternate and nothing is made of triangles.
  bool has_unused_diagonals() const { return unused_diagonals_; }

  /// How many unknowns move together: 3 of a particle, 1 of matrices.
  int unknowns_a_particle() const { return scene() ? 3 : 1; }
  /// Of each free particle, or unknown of matrices that was not condensed, its number in the input, from 0:
  /// of a mesh file the first vertex that lies there.
  std::vector<long> particle_numbers() const;
  /// The same of all particles of a scene, pinned ones too.
  std::vector<long> vertex_numbers() const;

  /// Of a scene, particles that are held.
  const std::vector<int>& pinned() const { return pinned_; }
  /// The scene without its contact, with all these particles held where they start, the pinned ones among
  /// them: what acts between held particles alone is left out.
  Model holding(const std::vector<int>& held) const { return make_model_(held); }

  /// Of a scene whose unknowns are x; nothing for matrices. Refers to this object.
  std::optional<ElementsOf> elements(const Vector& x) const;

  /// Of a scene of springs alone, what makes the matrices that no pose and no contact exceeds
  /// (solvers/scene/every_pose.h), also when this object is gone; else nothing.
  std::function<StructuralMatrices()> every_pose() const;

 private:
  void build_scene(const SceneDescription& description);
  template <class Cloth>
  void place(Cloth cloth, const SceneDescription& description, std::vector<int> pinned,
             const std::string& source);
  template <class Cloth>
  void add_contact(const ContactDescription& description, const Cloth& cloth, Scene& scene);
  std::pair<ClothSurface, SurfaceNames> contact_surface(const Scene& scene) const;
  void expect_apart(const ContactDescription& description);
  int number_in_file(int particle) const;
  void build_matrices(const InputOptions& options, bool any_matrices);

  mutable Faces faces_;       // of a grid none before they are asked for
  std::optional<Grid> grid_;  // where the scene is made of one
  std::optional<MeshFile> mesh_file_;
  std::shared_ptr<const SpringNet> net_;  // of a scene of springs
  std::vector<int> pinned_;
  std::vector<long> kept_;  // of matrices
  std::function<Model(const std::vector<int>& held)> make_model_;
  std::function<void(const std::vector<Eigen::Vector3d>& at, const ElementVisitor& visit)> visit_elements_;
  std::optional<SceneSize> size_;
  bool unused_diagonals_ = false;
  std::optional<Material> material_;
  std::optional<Contact> contact_;
  std::vector<std::string> contact_notes_;
  std::shared_ptr<SurfaceTouches> touches_;  // by springs between surfaces
  Eigen::Vector3d stretch_{1, 1, 1};
};

/// Throws InputError where alpha cannot be left to the design.
void expect_designable(const Model& model);

/// Throws InputError(option, ...) where the model has contact, which `option` takes no account of.
void expect_no_contact(const Subject& subject, const std::string& option);

}  // namespace springstab
