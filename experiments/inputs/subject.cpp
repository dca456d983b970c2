#include "experiments/inputs/subject.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <type_traits>

#include "experiments/inputs/grid.h"
#include "experiments/inputs/pinned.h"
#include "solvers/contact/penalty.h"
#include "solvers/contact/surface_penalty.h"
#include "solvers/io/input_error.h"
#include "solvers/io/matrix_file.h"
#include "solvers/io/mesh_file.h"
#include "solvers/io/text_file.h"
#include "solvers/scene/quantities.h"

namespace springstab {
namespace {

template <class Geometry>
SpringNet make(const Geometry& geometry, const SpringMaterial& material) {
  return make_net(geometry, material);
}
template <class Geometry>
TriangleCloth make(const Geometry& geometry, const ClothMaterial& material) {
  return make_cloth(geometry, material);
}

// Calls visit with the material of a surface.
template <class Visit>
void visit_cloth(const Material& material, const std::string& source, const Visit& visit) {
  if (const auto* springs = std::get_if<SpringMaterial>(&material)) return visit(*springs);
  if (const auto* cloth = std::get_if<ClothMaterial>(&material)) return visit(*cloth);
  throw InputError(source, 0, "is a surface, expected a material of the model 'springs' or 'baraff-witkin'");
}

// Names the file in what the matrix library says.
template <class Build>
auto naming(const std::string& source, Build build) {
  try {
    return build();
  } catch (const std::invalid_argument& error) {
    throw InputError(source, 0, error.what());
  }
}

// Calls visit(i, j, length) for the edges: of a net or a solid they are springs, of triangles sides.
template <class Visit>
void visit_edges(const std::vector<Spring>& springs, const Visit& visit) {
  for (const Spring& s : springs) visit(s.i, s.j, s.rest_length);
}
template <class Visit>
void visit_edges(const SpringNet& net, const Visit& visit) {
  visit_edges(net.springs, visit);
}
template <class Visit>
void visit_edges(const TetSolid& solid, const Visit& visit) {
  visit_edges(solid.edges, visit);
}
template <class Visit>
void visit_edges(const TriangleCloth& cloth, const Visit& visit) {
  const auto side = [&](int i, int j) { visit(i, j, (cloth.rest[i] - cloth.rest[j]).norm()); };
  for (const auto& [p, uv] : cloth.triangles)
    for (int c = 0; c < 3; ++c) side(p[c], p[(c + 1) % 3]);
  for (const Hinge& hinge : cloth.hinges) side(hinge.particles[0], hinge.particles[1]);
}

SceneSize elements_of(const SpringNet& net) { return {{}, 0, static_cast<long>(net.springs.size()), 0, 0}; }
SceneSize elements_of(const TetSolid& solid) {
  return {{}, 0, static_cast<long>(solid.edges.size() + solid.altitudes.size()), 0, 0};
}
SceneSize elements_of(const TriangleCloth& cloth) {
  return {{}, 0, 0, static_cast<long>(cloth.triangles.size()), static_cast<long>(cloth.hinges.size())};
}

template <class Cloth>
SceneSize size_of(const Cloth& cloth) {
  SceneSize size = elements_of(cloth);
  visit_edges(cloth, [&](int, int, double length) {
    size.shortest_edge = std::min(size.shortest_edge.value_or(length), length);
  });
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& place : cloth.rest) box.extend(place);
  size.extent = box.sizes();
  size.mass = std::accumulate(cloth.mass.begin(), cloth.mass.end(), 0.0);
  return size;
}

void scale_by(double scale, std::vector<Eigen::Vector3d>& vertices) {
  for (Eigen::Vector3d& vertex : vertices) vertex *= scale;
}

// Scales the masses so that their sum is `total`.
void weigh(double total, std::vector<double>& masses) {
  const double sum = std::accumulate(masses.begin(), masses.end(), 0.0);
  for (double& mass : masses) mass *= total / sum;
}

// At rest but for `stretch` and `velocity`.
State<Vector> start_of(const Scene& scene, const InitialDescription& initial) {
  State<Vector> state = scene.rest_state();
  for (Eigen::Index i = 0; i < state.x.size(); ++i) {
    state.x[i] *= initial.stretch[i % 3];
    state.v[i] = initial.velocity[i % 3];
  }
  return state;
}

}  // namespace

Subject::Subject(const InputOptions& options, bool any_matrices) {
  springstab::check(options);
  if (options.stiffness.empty()) {
    build_scene(describe(options));
  } else {
    build_matrices(options, any_matrices);
  }
}

void Subject::build_matrices(const InputOptions& options, bool any_matrices) {
  const Duplicates duplicates = options.sum_duplicates ? Duplicates::summed : Duplicates::refused;
  const auto read = [&](const std::string& path) {
    return path.empty() ? SparseMatrix() : read_matrix(path, duplicates);
  };
  const SparseMatrix k = read(options.stiffness), m = read(options.mass), d = read(options.damping_matrix),
                     implicit = read(options.implicit_damping_matrix);
  const RayleighDamping rayleigh = rayleigh_of(options);
  std::string files = options.stiffness;
  for (const std::string* file : {&options.mass, &options.damping_matrix, &options.implicit_damping_matrix})
    if (!file->empty()) files += ", " + *file;
  *this = naming(files, [&] { return Subject(k, m, d, implicit, rayleigh, any_matrices); });
}

Subject::Subject(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseMatrix& damping,
                 const SparseMatrix& implicit_damping, const RayleighDamping& rayleigh, bool any_matrices)
    : Model(std::make_unique<MatrixSystem>((any_matrices ? prepare_nonsymmetric : prepare)(
          stiffness, mass, damping, rayleigh, implicit_damping))) {
  const Eigen::VectorXd weight = mass.size() > 0
                                     ? Eigen::VectorXd(mass.cwiseAbs() * Eigen::VectorXd::Ones(mass.cols()))
                                     : Eigen::VectorXd::Ones(stiffness.rows());
  for (long i = 0; i < weight.size(); ++i)
    if (weight[i] > 0) kept_.push_back(i);
}

Subject::Subject(const SceneDescription& description) { build_scene(description); }

void Subject::build_scene(const SceneDescription& description) {
  material_ = description.material;
  if (std::holds_alternative<Grid>(description.geometry)) {
    Grid grid = std::get<Grid>(description.geometry);
    grid.spacing *= description.scale;
    grid_ = grid;
    unused_diagonals_ = grid.diagonals == Diagonals::alternating &&
                        !std::holds_alternative<ClothMaterial>(description.material);
    return visit_cloth(description.material, "--grid", [&](const auto& material) {
      auto cloth = make(grid, material);
      place(std::move(cloth), description, pinned_particles(description.pins, grid), "--grid");
    });
  }
  const std::string& path = std::get<std::string>(description.geometry);
  const auto place_mesh = [&](auto cloth) {
    place(std::move(cloth), description, pinned_particles(description.pins, *mesh_file_, faces_), path);
  };
  AnyMesh mesh = read_mesh(path);
  if (auto* tets = std::get_if<TetMesh>(&mesh)) {
    const SolidMaterial* material = std::get_if<SolidMaterial>(&description.material);
    scale_by(description.scale, tets->vertices);
    if (!material) throw InputError(path, 0, "has tetrahedra, expected a material of the model 'tetrahedra'");
    SolidInput input = solid_input(std::move(*tets));
    mesh_file_ = std::move(input.file);
    faces_ = std::move(input.faces);
    return place_mesh(make_solid(input.mesh, *material));
  }
  scale_by(description.scale, std::get<Mesh>(mesh).vertices);
  SurfaceInput input = surface_input(std::move(std::get<Mesh>(mesh)));
  mesh_file_ = std::move(input.file);
  faces_ = std::move(input.faces);
  visit_cloth(description.material, path,
              [&](const auto& material) { place_mesh(make(input.mesh, material)); });
}

template <class Cloth>
void Subject::place(Cloth made, const SceneDescription& description, std::vector<int> pinned,
                    const std::string& source) {
  if (description.total_mass) weigh(*description.total_mass, made.mass);
  const auto shared = std::make_shared<const Cloth>(std::move(made));
  const Cloth& cloth = *shared;
  pinned_ = std::move(pinned);
  stretch_ = description.initial.stretch;
  size_ = size_of(cloth);
  visit_elements_ = [shared](const auto& at, const ElementVisitor& visit) {
    visit_elements(*shared, at, visit);
  };
  if constexpr (std::is_same_v<Cloth, SpringNet>) net_ = shared;
  if constexpr (std::is_same_v<Cloth, TriangleCloth>)
    if (mesh_file_) {
      mesh_file_->rest_shape = cloth.rest_shape;
      mesh_file_->texture_map = cloth.texture_map;
    }
  const RayleighDamping own{description.damping.d0, description.damping.alpha.value_or(0)};
  const auto make_scene = [shared, own, gravity = description.gravity,
                           stretch = stretch_](const std::vector<int>& held) {
    auto scene = std::make_unique<Scene>(*shared, held, gravity, own);
    std::vector<Eigen::Vector3d> places;
    for (int i : held) places.push_back(stretch.cwiseProduct(shared->rest[i]));
    scene->place_pinned(places);
    return scene;
  };
  make_model_ = [make_scene, initial = description.initial](const std::vector<int>& held) {
    auto scene = make_scene(held);
    State<Vector> start = start_of(*scene, initial);
    return Model(std::move(scene), std::move(start));
  };
  auto scene = naming(description.pins.source.empty() ? source : description.pins.source,
                      [&] { return make_scene(pinned_); });
  if (description.contact) add_contact(*description.contact, cloth, *scene);
  State<Vector> start = start_of(*scene, description.initial);
  Model::operator=(Model(std::move(scene), std::move(start)));
  if (description.contact) expect_apart(*description.contact);
  if (!description.damping.alpha && damping().kind != DampingModel::Kind::general) design_damping();
}

// By its name in the input: that of a vertex of the file where there is one.
int Subject::number_in_file(int particle) const {
  if (!mesh_file_) return particle;
  const auto& of = mesh_file_->repair.vertex;
  return static_cast<int>(std::find(of.begin(), of.end(), particle) - of.begin());
}

template <class Cloth>
void Subject::add_contact(const ContactDescription& description, const Cloth& cloth, Scene& scene) {
  contact_ = contact_of(description, contact_notes_);
  visit_edges(cloth, [&](int i, int j, double length) {
    if (contact_->thickness <= length) return;
    const Location at{description.source, description.thickness_line};
    at.fail("'thickness' is " + shown(contact_->thickness) + " m, expected at most the edge " +
            std::to_string(number_in_file(i)) + "-" + std::to_string(number_in_file(j)) + " of " +
            shown(length) + " m");
  });
  if (!std::holds_alternative<Penalty>(contact_->model)) return;
  if (!contact_->obstacles.empty()) scene.add(penalty_terms(*contact_));
  if (!contact_->has_surfaces()) return;
  const ClothSurface surface = contact_surface(scene).first;
  expect_faces(description, surface);
  touches_ = std::make_shared<SurfaceTouches>(*contact_, scene.free_particles(), surface);
  scene.add(surface_penalty_terms(*contact_, touches_));
}

void Subject::expect_apart(const ContactDescription& description) {
  const Vector x = initial_state().x;
  const auto fail = [&](const Intersection& found, const std::string& what, const char* expected) {
    const ObstaclePlace& place = description.places[found.obstacle];
    const Location at{description.source, place.line};
    at.fail("obstacle " + std::to_string(place.number) + " holds " + what + " of the cloth at the start, " +
            shown(found.depth) + " m deep, expected " + expected);
  };
  if (const auto found =
          first_particle_inside(contact_->obstacles, contact_->thickness, scene()->positions(x)))
    fail(*found, (mesh_file_ ? "vertex " : "particle ") + std::to_string(number_in_file(found->index)),
         contact_->thickness > 0 ? "them apart by the thickness" : "them apart");
  if (const auto found = first_face_inside(contact_->obstacles, vertices(x), faces()))
    fail(*found, "face " + std::to_string(found->index), "them apart");
  if (!contact_->has_surfaces()) return;
  const auto [surface, names] = contact_surface();
  expect_surfaces_apart(description, *contact_, surface, x, names);
}

void expect_no_contact(const Subject& subject, const std::string& option) {
  if (subject.contact())
    throw InputError(option, 0, "takes no account of contact, expected a scene without 'contact'");
}

void expect_designable(const Model& model) {
  if (!model.scene())
    throw InputError("--damping", 0, "'designed' is for scenes, expected 'own' for matrices");
  if (model.damping().kind == DampingModel::Kind::general)
    throw InputError("--damping", 0,
                     "'designed' is not possible beside the springs' own damping, expected 'own'");
}

}  // namespace springstab
