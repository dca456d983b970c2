// Scenes, assembled by rank from the project's own terms: of a grid each rank makes the scene of strips of
// its box and of the particles around them; of a mesh, which all ranks read, the scene with all particles
// held but its own and their neighbours. Either way the rows of its own particles are whole.
#include <algorithm>
#include <numeric>

#include "analysis/proofs/graph_parts.h"
#include "experiments/inputs/pinned.h"
#include "experiments/mpi/agreement.h"
#include "experiments/mpi/block_rows.h"
#include "experiments/mpi/grid_layout.h"
#include "experiments/mpi/system.h"
#include "solvers/io/input_error.h"

namespace springstab::mpi {
namespace {

constexpr long particles_a_strip = 40'000;
constexpr long reach = 2;  // of an element, in rows or columns

// The rows of a rank: of K and C, and what its particles weigh.
struct SceneRows {
  BlockRows stiffness, damping;
  std::vector<double> mass;

  /// Of a part of the scene; number[i] is that of its free particle i.
  void append(Model& part, const std::vector<long>& number, const IndexRange& own) {
    const auto linear = part.scene()->linearization(part.initial_state());
    stiffness.append(linear->stiffness(), number, own);
    const std::size_t before = mass.size();
    for (std::size_t i = 0; i < number.size(); ++i)
      if (own.holds(number[i])) mass.push_back(linear->mass()[i]);
    if (const BlockSparseMatrix* own_damping = linear->own_damping()) {
      damping.append(*own_damping, number, own);
    } else {
      damping.append_empty(mass.size() - before);
    }
  }
};

OwnedVec vector_of_masses(Mat a, const std::vector<double>& mass) {
  OwnedVec v = vector_like(a);
  PetscScalar* entries = nullptr;
  petsc(VecGetArray(v, &entries));
  for (std::size_t i = 0; i < 3 * mass.size(); ++i) entries[i] = mass[i / 3];
  petsc(VecRestoreArray(v, &entries));
  return v;
}

// D = d0 M + alpha K + C
OwnedMat whole_damping(Mat stiffness, Mat own, Vec mass, const DampingModel& model) {
  OwnedMat damping = copy_of(stiffness);
  petsc(MatScale(damping, model.alpha));
  petsc(MatAXPY(damping, 1, own, SUBSET_NONZERO_PATTERN));
  OwnedVec diagonal = diagonal_of(damping);
  petsc(VecAXPY(diagonal, model.d0, mass));
  petsc(MatDiagonalSet(damping, diagonal, INSERT_VALUES));
  return damping;
}

System assembled(SceneRows rows, long particles, const DampingModel& model) {
  System system;
  system.model = model;
  system.unknowns_a_node = 3;
  system.size = static_cast<PetscInt>(3 * particles);
  system.stiffness = std::move(rows.stiffness).assemble(particles);
  const OwnedVec mass = vector_of_masses(system.stiffness, rows.mass), root = vector_like(system.stiffness);
  petsc(VecCopy(mass, root));
  petsc(VecSqrtAbs(root));
  petsc(VecReciprocal(root));
  if (model.kind == DampingModel::Kind::general) {
    const OwnedMat own = std::move(rows.damping).assemble(particles);
    system.damping = whole_damping(system.stiffness, own, mass, model);
    scale(system.damping, root);
  }
  scale(system.stiffness, root);
  return system;
}

// --- grids ---

// A description of rows and columns of the grid alone.
struct SubGrid {
  SceneDescription description;
  long first_row, first_column, rows, columns;
};

SubGrid sub_grid(const SceneDescription& whole, const GridLayout& layout, const GridLayout::Box& box) {
  const Grid& grid = std::get<Grid>(whole.geometry);
  long top = std::max(box.rows.first - reach, 0L), left = std::max(box.columns.first - reach, 0L);
  // Diagonals that alternate do so from an even particle.
  if ((top + left) % 2 != 0) top > 0 ? --top : --left;
  const long bottom = std::min<long>(box.rows.last + reach, grid.rows),
             right = std::min<long>(box.columns.last + reach, grid.columns);
  SubGrid sub{whole, top, left, bottom - top, right - left};
  Grid part = grid;
  part.rows = static_cast<int>(sub.rows);
  part.columns = static_cast<int>(sub.columns);
  sub.description.geometry = part;
  Pins& pins = sub.description.pins;
  pins.kind = Pins::Kind::none;
  pins.ranges.clear();
  for (long k = 0; k < sub.rows * sub.columns; ++k)
    if (layout.number(top + k / sub.columns, left + k % sub.columns) < 0)
      pins.ranges.push_back({static_cast<int>(k), static_cast<int>(k)}), pins.kind = Pins::Kind::indices;
  if (whole.total_mass)
    sub.description.total_mass = *whole.total_mass * static_cast<double>(sub.rows * sub.columns) /
                                 (static_cast<double>(grid.rows) * grid.columns);
  return sub;
}

void append_strip(const SceneDescription& whole, const GridLayout& layout, const GridLayout::Box& strip,
                  SceneRows& rows) {
  const SubGrid sub = sub_grid(whole, layout, strip);
  std::vector<long> number;
  for (long k = 0; k < sub.rows * sub.columns; ++k)
    if (const long n = layout.number(sub.first_row + k / sub.columns, sub.first_column + k % sub.columns);
        n >= 0)
      number.push_back(n);
  // Its own particles are consecutive: those from the strip's first free one to its last.
  IndexRange own{-1, -1};
  for (long row = strip.rows.first; row < strip.rows.last; ++row)
    for (long column = strip.columns.first; column < strip.columns.last; ++column)
      if (const long n = layout.number(row, column); n >= 0) {
        if (own.first < 0) own.first = n;
        own.last = n + 1;
      }
  if (own.first < 0) return;
  Subject part(sub.description);
  rows.append(part, number, own);
}

Grid sample_grid(Grid grid) {
  if (grid.rows < 2 || grid.columns < 2) return grid;  // which may be too narrow
  grid.rows = std::min(grid.rows, 4);
  grid.columns = std::min(grid.columns, 4);
  return grid;
}

// What is said of the damping and the masses of a whole grid, from a small one of its kind.
Subject sample_of(SceneDescription description) {
  const Grid whole = std::get<Grid>(description.geometry);
  std::get<Grid>(description.geometry) = sample_grid(whole);
  const Grid& sample = std::get<Grid>(description.geometry);
  description.pins = {};
  if (description.total_mass)
    *description.total_mass *= static_cast<double>(sample.rows) * sample.columns / whole.rows / whole.columns;
  return Subject(description);
}

SceneSize whole_size(const SceneSize& sample, const Grid& grid, double scale) {
  const Grid small = sample_grid(grid);
  SceneSize size = sample;
  size.extent = {(grid.columns - 1) * grid.spacing * scale, 0, (grid.rows - 1) * grid.spacing * scale};
  size.mass *= static_cast<double>(grid.rows) / small.rows * grid.columns / small.columns;
  size.springs = size.triangles = size.hinges = 0;  // not counted
  return size;
}

System grid_system(const SceneDescription& description) {
  const Grid& grid = std::get<Grid>(description.geometry);
  SceneRows rows;
  System system;
  DampingModel model;
  std::optional<SceneSize> size;
  long particles = 0;
  together([&] {
    const std::vector<int> pinned = pinned_particles(description.pins, grid);
    const GridLayout layout(grid, pinned, ranks());
    particles = layout.numbers(ranks() - 1).last;
    if (particles == 0)
      throw InputError(description.pins.source, 0,
                       "all particles are pinned, expected at least one that can move");
    const Subject sample = sample_of(description);
    model = sample.damping();
    size = whole_size(*sample.scene_size(), grid, description.scale);
    const GridLayout::Box box = layout.box(rank());
    const IndexRange own = layout.numbers(rank());
    rows.stiffness.expect(own.last - own.first);
    rows.damping.expect(own.last - own.first);
    const long height = std::max(1L, particles_a_strip / std::max(1L, box.width()));
    for (long top = box.rows.first; top < box.rows.last; top += height)
      append_strip(description, layout, {{top, std::min(top + height, box.rows.last)}, box.columns}, rows);
  });
  system = assembled(std::move(rows), particles, model);
  system.scene_size = size;
  return system;
}

// --- meshes ---

// Calls visit(i, j) for free particles that a term couples.
template <class Visit>
void for_each_coupling(const Scene& scene, const Visit& visit) {
  const auto all = [&](const auto& terms) {
    for (const auto& term : terms)
      for (const auto& [i, j] : term->couplings()) visit(i, j);
  };
  all(scene.terms().elastic);
  all(scene.terms().damping);
}

// Who has which free particle: parts of the graph of what couples them.
std::vector<int> owners_of(const Scene& scene) {
  std::vector<std::vector<int>> near(static_cast<std::size_t>(scene.free_particles()));
  for_each_coupling(scene, [&](int i, int j) { near[i].push_back(j), near[j].push_back(i); });
  Graph graph;
  for (std::vector<int>& list : near) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbour.insert(graph.neighbour.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return parts_of(graph, ranks());
}

// Free particles that couple with own ones, and those.
std::vector<char> own_and_near(const Scene& scene, const std::vector<int>& owner) {
  std::vector<char> wanted(owner.size());
  for (std::size_t i = 0; i < owner.size(); ++i) wanted[i] = owner[i] == rank();
  for_each_coupling(scene, [&](int i, int j) {
    if (owner[i] == rank()) wanted[j] = 1;
    if (owner[j] == rank()) wanted[i] = 1;
  });
  return wanted;
}

// Of a rank: which particles of the mesh it holds fast, what the numbers of the others are, and which are its
// own.
struct MeshPart {
  std::vector<int> held;
  std::vector<long> number;  // part by part, in the order of the particles
  IndexRange own{0, 0};
};

MeshPart own_part(const Subject& subject) {
  const Scene& scene = *subject.scene();
  const std::vector<int> owner = owners_of(scene);
  std::vector<long> number(owner.size());
  MeshPart mine;
  long next = 0;
  for (int part = 0; part < ranks(); ++part) {
    const long first = next;
    for (std::size_t i = 0; i < owner.size(); ++i)
      if (owner[i] == part) number[i] = next++;
    if (part == rank()) mine.own = {first, next};
  }
  const std::vector<char> wanted = own_and_near(scene, owner);
  for (int particle = 0, free = 0; particle < scene.particles(); ++particle) {
    const bool pinned = std::ranges::binary_search(subject.pinned(), particle);
    if (pinned || !wanted[free]) {
      mine.held.push_back(particle);
    } else {
      mine.number.push_back(number[free]);
    }
    if (!pinned) ++free;
  }
  return mine;
}

System mesh_system(const SceneDescription& description) {
  SceneRows rows;
  std::unique_ptr<Subject> subject;
  together([&] {
    subject = std::make_unique<Subject>(description);
    const MeshPart mine = own_part(*subject);
    if (mine.number.empty()) return;
    Model part = subject->holding(mine.held);
    rows.append(part, mine.number, mine.own);
  });
  System system = assembled(std::move(rows), subject->scene()->free_particles(), subject->damping());
  system.scene_size = subject->scene_size();
  system.mesh = std::move(subject);
  return system;
}

}  // namespace

System scene_system(const SceneDescription& description) {
  return std::holds_alternative<Grid>(description.geometry) ? grid_system(description)
                                                            : mesh_system(description);
}

}  // namespace springstab::mpi
