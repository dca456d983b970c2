#include "experiments/input/subject.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <type_traits>

#include "solvers/io/input_error.h"
#include "solvers/io/matrix_file.h"
#include "solvers/io/mesh_file.h"
#include "solvers/scene/every_pose.h"

namespace springstab {
namespace {

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         std::equal(ending.rbegin(), ending.rend(), text.rbegin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

std::vector<std::vector<int>> grid_faces(const Grid& grid) {
  std::vector<std::vector<int>> faces;
  for (int i = 0; i + 1 < grid.rows; ++i)
    for (int j = 0; j + 1 < grid.columns; ++j) {
      const int p = i * grid.columns + j;
      faces.push_back({p, p + 1, p + grid.columns + 1, p + grid.columns});
    }
  return faces;
}

// Particle numbers of the pins, ascending. Pins of a mesh file name its vertices.
std::vector<int> resolve(const Pins& pins, const Grid* grid, int particles);

std::vector<int> resolve(const Pins& pins, const MeshFile& file) {
  std::vector<int> numbers;
  for (const int vertex : resolve(pins, nullptr, static_cast<int>(file.vertices.size())))
    if (const int particle = file.repair.vertex[vertex]; particle >= 0) numbers.push_back(particle);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

std::vector<int> resolve(const Pins& pins, const Grid* grid, int particles) {
  const auto wrong = [&](const std::string& message) { return InputError(pins.source, pins.line, message); };
  if (pins.kind == Pins::Kind::none) return {};
  std::vector<int> numbers;
  if (pins.kind == Pins::Kind::indices) {
    if (!pins.ranges.empty() && pins.ranges.back().last >= particles)
      throw wrong("pinned particle " + std::to_string(pins.ranges.back().last) +
                  " does not exist, expected 0 to " + std::to_string(particles - 1));
    for (const Range& range : pins.ranges)
      for (int i = range.first; i <= range.last; ++i) numbers.push_back(i);
    return numbers;
  }
  if (!grid)
    throw wrong("'first-row' and 'corners' are places on a grid, expected particle numbers for a mesh");
  if (pins.kind == Pins::Kind::first_row) {
    for (int j = 0; j < grid->columns; ++j) numbers.push_back(j);
  } else {
    const int last = particles - 1;
    numbers = {0, grid->columns - 1, last - (grid->columns - 1), last};
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }
  return numbers;
}

SceneDescription describe(const InputOptions& options) {
  if (is_scene_file(options.file)) {
    if (options.spacing || !options.material.empty() || !options.pin.empty())
      throw InputError(options.file, 0, "--spacing, --material and --pin stand in the scene file itself");
    return read_scene_file(options.file);
  }
  SceneDescription description;
  if (options.grid.empty()) {
    if (options.spacing) throw InputError("--spacing", 0, "is for --grid only");
    description.geometry = options.file;
  } else {
    Grid grid = parse_grid(options.grid, "--grid");
    if (options.spacing) grid.spacing = *options.spacing;
    check(grid, "--grid");
    description.geometry = grid;
  }
  description.material = named_material(options.material.empty() ? "default" : options.material,
                                        is_solid(description.geometry), "--material", 0);
  if (!options.pin.empty()) description.pins = parse_pins(options.pin, "--pin", 0);
  return description;
}

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

// What a scene at rest has of elastic energy after 10^12 rounding errors, more than there are steps in a run:
// they walk 10^6 of them away.
double rounding_energy(Scene& scene, Vector x) {
  const double off = 1e6 * std::numeric_limits<double>::epsilon() * x.cwiseAbs().maxCoeff();
  std::mt19937 random(1);
  for (double& coordinate : x) coordinate += random() % 2 == 0 ? off : -off;
  return scene.elastic_energy(x);
}

}  // namespace

bool is_scene_file(const std::string& path) { return ends_with(path, ".json"); }

Grid parse_grid(const std::string& text, const std::string& source) {
  Grid grid;
  const char* end = text.data() + text.size();
  const auto rows = std::from_chars(text.data(), end, grid.rows);
  const bool cross = rows.ec == std::errc() && rows.ptr != end && (*rows.ptr == 'x' || *rows.ptr == 'X');
  const auto columns = cross ? std::from_chars(rows.ptr + 1, end, grid.columns) : rows;
  if (!cross || columns.ec != std::errc() || columns.ptr != end)
    throw InputError(source, 0, "'" + text + "' is not a size, expected ROWSxCOLUMNS like 32x32");
  check(grid, source);
  return grid;
}

Subject::Subject(const InputOptions& options, bool any_matrices) {
  const int given = !options.file.empty() + !options.grid.empty() + !options.stiffness.empty();
  if (given != 1)
    throw InputError("input", 0,
                     std::string(given == 0 ? "nothing was given" : "more than one was given") +
                         ", expected one of SCENE.json, a mesh, --grid NxM or --stiffness K.mtx");
  if (options.stiffness.empty()) {
    if (!options.mass.empty() || !options.damping_matrix.empty() || options.sum_duplicates)
      throw InputError("input", 0, "--mass, --damping-matrix and --sum-duplicates go with --stiffness");
    build_scene(describe(options));
  } else {
    build_matrices(options, any_matrices);
  }
}

void Subject::build_matrices(const InputOptions& options, bool any_matrices) {
  if (options.spacing || !options.material.empty() || !options.pin.empty())
    throw InputError(options.stiffness, 0, "--spacing, --material and --pin are for grids and meshes");
  const Duplicates duplicates = options.sum_duplicates ? Duplicates::summed : Duplicates::refused;
  const auto read = [&](const std::string& path) {
    return path.empty() ? SparseMatrix() : read_matrix(path, duplicates);
  };
  const SparseMatrix k = read(options.stiffness), m = read(options.mass), d = read(options.damping_matrix);
  std::string files = options.stiffness;
  for (const std::string* file : {&options.mass, &options.damping_matrix})
    if (!file->empty()) files += ", " + *file;
  matrices_ = naming(files, [&] {
    const auto& make = any_matrices ? prepare_nonsymmetric : prepare;
    return std::make_unique<MatrixSystem>(make(k, m, d));
  });
}

Subject::Subject(const SceneDescription& description) { build_scene(description); }

void Subject::build_scene(const SceneDescription& description) {
  material_ = description.material;
  if (const Grid* grid = std::get_if<Grid>(&description.geometry)) {
    faces_ = grid_faces(*grid);
    visit_cloth(description.material, "--grid",
                [&](const auto& material) { place(make(*grid, material), description, grid, "--grid"); });
    return;
  }
  const std::string& file = std::get<std::string>(description.geometry);
  AnyMesh mesh = read_mesh(file);
  if (auto* solid = std::get_if<TetMesh>(&mesh)) return build_solid(std::move(*solid), description);
  build_surface(std::move(std::get<Mesh>(mesh)), description);
}

void Subject::build_surface(Mesh original, const SceneDescription& description) {
  const std::string& file = original.source;
  for (int f = 0; f < original.faces(); ++f)
    faces_.emplace_back(original.face(f).begin(), original.face(f).end());
  RepairedMesh mended = repaired(original);
  mesh_file_ = MeshFile{file, false, std::move(original.vertices), std::move(mended.repair),
                        std::move(original.notes)};
  visit_cloth(description.material, file,
              [&](const auto& material) { place(make(mended.mesh, material), description, nullptr, file); });
}

void Subject::build_solid(TetMesh original, const SceneDescription& description) {
  const std::string& file = original.source;
  const SolidMaterial* material = std::get_if<SolidMaterial>(&description.material);
  if (!material) throw InputError(file, 0, "has tetrahedra, expected a material of the model 'tetrahedra'");
  auto [mesh, repair] = repaired(original);
  std::vector<int> of_file(mesh.vertices.size());  // the first vertex that each one was
  for (std::size_t v = repair.vertex.size(); v-- > 0;)
    if (repair.vertex[v] >= 0) of_file[repair.vertex[v]] = static_cast<int>(v);
  for (std::vector<int> face : boundary(mesh)) {
    for (int& v : face) v = of_file[v];
    faces_.push_back(std::move(face));
  }
  mesh_file_ =
      MeshFile{file, true, std::move(original.vertices), std::move(repair), std::move(original.notes)};
  place(make_solid(mesh, *material), description, nullptr, file);
}

template <class Cloth>
void Subject::place(const Cloth& cloth, const SceneDescription& description, const Grid* grid,
                    const std::string& source) {
  rayleigh_ = description.damping;
  initial_ = description.initial;
  const std::vector<int> pinned = mesh_file_
                                      ? resolve(description.pins, *mesh_file_)
                                      : resolve(description.pins, grid, static_cast<int>(cloth.rest.size()));
  if constexpr (std::is_same_v<Cloth, SpringNet>) net_ = cloth;
  if constexpr (std::is_same_v<Cloth, TriangleCloth>)
    if (mesh_file_) {
      mesh_file_->rest_shape = cloth.rest_shape;
      mesh_file_->texture_map = cloth.texture_map;
    }
  pinned_ = pinned;
  const std::string pins_source = description.pins.source.empty() ? source : description.pins.source;
  scene_ = naming(pins_source, [&] {
    return std::make_unique<Scene>(cloth, pinned, description.gravity,
                                   RayleighDamping{rayleigh_.d0, rayleigh_.alpha.value_or(0)});
  });
  std::vector<Eigen::Vector3d> places;
  for (int i : pinned) places.push_back(initial_.stretch.cwiseProduct(cloth.rest[i]));
  scene_->place_pinned(places);
}

std::vector<Eigen::Vector3d> Subject::vertices(const Vector& x) const {
  std::vector<Eigen::Vector3d> particles = scene_->positions(x);
  if (!mesh_file_) return particles;
  std::vector<Eigen::Vector3d> all;
  for (std::size_t v = 0; v < mesh_file_->vertices.size(); ++v) {
    const int particle = mesh_file_->repair.vertex[v];
    all.push_back(particle < 0 ? initial_.stretch.cwiseProduct(mesh_file_->vertices[v])
                               : particles[particle]);
  }
  return all;
}

System& Subject::system() {
  if (scene_) return *scene_;
  return *matrices_;
}

State<Vector> Subject::initial_state(std::uint64_t seed) {
  if (scene_) {
    State<Vector> state = scene_->rest_state();
    for (Eigen::Index i = 0; i < state.x.size(); ++i) {
      state.x[i] *= initial_.stretch[i % 3];
      state.v[i] = initial_.velocity[i % 3];
    }
    return state;
  }
  State<Vector> state{Vector(matrices_->size()), Vector::Zero(matrices_->size())};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (double& entry : state.x) entry = uniform(random);
  state.x /= std::sqrt(2 * matrices_->kinetic_energy(state.x));  // xᵀMx = 1
  return state;
}

EnergyWatch Subject::energy_watch(const State<Vector>& start) {
  EnergyWatch watch;
  watch.initial_energy = system().kinetic_energy(start.v);
  if (scene_) {
    watch.initial_energy += std::max(scene_->elastic_energy(start.x), rounding_energy(*scene_, start.x));
    watch.gravity = scene_->gravity().norm();
    watch.mass = scene_->total_free_mass();
  } else {
    watch.initial_energy += matrices_->potential_energy(start.x);
    watch.may_grow = true;
  }
  watch.initial_total = system().kinetic_energy(start.v) + system().potential_energy(start.x);
  return watch;
}

StructuralMatrices Subject::structure(const State<Vector>& state) {
  if (matrices_) return matrices_->matrices();
  BlockLinearSystem& linear = scene_->linearized(state.x, state.v);
  StructuralMatrices s;
  s.stiffness = linear.stiffness().to_sparse();
  Vector mass(scene_->size());
  for (Eigen::Index i = 0; i < mass.size(); ++i) mass[i] = linear.mass()[i / 3];
  s.mass = SparseMatrix(mass.asDiagonal());
  if (const BlockSparseMatrix* own = linear.own_damping())
    s.damping = linear.damping().d0 * s.mass + linear.damping().alpha * s.stiffness + own->to_sparse();
  return s;
}

std::optional<StructuralMatrices> Subject::every_pose() const {
  if (!net_) return std::nullopt;
  return springstab::every_pose(*net_, pinned_, {rayleigh_.d0, rayleigh_.alpha.value_or(0)});
}

DampingModel Subject::damping() {
  if (matrices_) return classify_damping(matrices_->matrices());
  using Kind = DampingModel::Kind;
  const double alpha = rayleigh_.alpha.value_or(0);
  const Kind kind = scene_->has_own_damping()         ? Kind::general
                    : !rayleigh_.alpha                ? Kind::designed
                    : rayleigh_.d0 == 0 && alpha == 0 ? Kind::none
                                                      : Kind::rayleigh;
  return {kind, rayleigh_.d0, alpha};
}

void Subject::design_damping() {
  if (!scene_) throw InputError("--damping", 0, "'designed' is for scenes, expected 'own' for matrices");
  if (scene_->has_own_damping())
    throw InputError("--damping", 0,
                     "'designed' is not possible beside the springs' own damping, expected 'own'");
  rayleigh_.alpha.reset();
}

void Subject::set_alpha(double alpha) {
  rayleigh_.alpha = alpha;
  scene_->set_damping({rayleigh_.d0, alpha});
}

}  // namespace springstab
