#include "experiments/mpi/proof.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "analysis/constants.h"
#include "analysis/proofs/graph_parts.h"
#include "analysis/proofs/sum_of_couplings.h"
#include "experiments/mpi/agreement.h"

namespace springstab::mpi {
namespace {

// Rows and columns of a matrix, which each rank chooses for itself. (A sparse matrix of Eigen's is copied
// where others are moved, so large ones are filled where they stay.)
void take_part(Mat a, IS chosen, SparseMatrix& part) {
  Mat* parts = nullptr;
  petsc(MatCreateSubMatrices(a, 1, &chosen, &chosen, MAT_INITIAL_MATRIX, &parts));
  PetscInt size = 0;
  petsc(ISGetLocalSize(chosen, &size));
  part.resize(size, size);
  long entries = 0;
  for (PetscInt i = 0; i < size; ++i) entries += Row(parts[0], i).size();
  part.reserve(entries);
  for (PetscInt j = 0; j < size; ++j) {  // symmetric: its rows are its columns
    part.startVec(j);
    const Row row(parts[0], j);
    for (int k = 0; k < row.size(); ++k) part.insertBack(row.column(k), j) = row.value(k);
  }
  part.finalize();
  petsc(MatDestroySubMatrices(1, &parts));
}

void take_part(const System& system, IS chosen, StructuralMatrices& s) {
  take_part(system.stiffness, chosen, s.stiffness);
  if (system.damping) take_part(system.damping, chosen, s.damping);
  if (system.mass) {
    take_part(system.mass, chosen, s.mass);
  } else {
    s.mass.resize(s.stiffness.rows(), s.stiffness.rows());
    s.mass.setIdentity();
  }
}

OwnedIS stride(PetscInt first, PetscInt last) {
  OwnedIS rows;
  petsc(ISCreateStride(PETSC_COMM_SELF, last - first, first, 1, rows.out()));
  return rows;
}

// The first rank's: everything, the others': nothing.
OwnedIS all_for_the_first(const System& system) { return stride(0, rank() == 0 ? system.size : 0); }

bool told_by_the_first(bool verdict) {
  int value = verdict ? 1 : 0;
  MPI_Bcast(&value, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  return value == 1;
}

// A matrix with an entry wherever one of them has.
OwnedMat pattern_of(const System& system) {
  OwnedMat pattern = copy_of(system.stiffness);
  if (system.damping) petsc(MatAXPY(pattern, 1, system.damping, DIFFERENT_NONZERO_PATTERN));
  if (system.mass) petsc(MatAXPY(pattern, 1, system.mass, DIFFERENT_NONZERO_PATTERN));
  return pattern;
}

// A rank's rows, and those up to as many entries away.
OwnedIS rows_around(const System& system, int layers) {
  OwnedMat pattern;
  if (!system.one_pattern) pattern = pattern_of(system);
  const Mat graph = system.one_pattern ? static_cast<Mat>(system.stiffness) : static_cast<Mat>(pattern);
  const OwnRows own(graph);
  OwnedIS rows = stride(own.first, own.last);
  petsc(MatIncreaseOverlap(graph, 1, rows.at(), layers));
  petsc(ISSort(rows));
  return rows;
}

// The parts of a rank's own nodes; they are the nodes [first, last) of `around`.
std::vector<int> own_parts(const Graph& around, int first, int last, int layers) {
  Graph own;
  for (int node = first; node < last; ++node) {
    for (int k = around.start[node]; k < around.start[node + 1]; ++k)
      if (const int other = around.neighbour[k]; other >= first && other < last)
        own.neighbour.push_back(other - first);
    own.start.push_back(static_cast<int>(own.neighbour.size()));
  }
  const int particles = Pieces::cheapest_particles(around, layers);
  return parts_of(own, (own.size() + particles - 1) / particles);
}

// `own`, a number for each of a rank's nodes, as all ranks together have it, at the rows chosen.
std::vector<double> at_rows(const System& system, const std::vector<double>& own, IS rows) {
  const OwnedVec all = vector_like(system.stiffness);
  OwnedVec here;
  OwnedScatter scatter;
  PetscInt size = 0;
  PetscScalar* entries = nullptr;
  const std::size_t group = static_cast<std::size_t>(system.unknowns_a_node);
  petsc(VecGetArray(all, &entries));
  for (std::size_t i = 0; i < group * own.size(); ++i) entries[i] = own[i / group];
  petsc(VecRestoreArray(all, &entries));
  petsc(ISGetLocalSize(rows, &size));
  petsc(VecCreateSeq(PETSC_COMM_SELF, size, here.out()));
  petsc(VecScatterCreate(all, rows, here, nullptr, scatter.out()));
  petsc(VecScatterBegin(scatter, all, here, INSERT_VALUES, SCATTER_FORWARD));
  petsc(VecScatterEnd(scatter, all, here, INSERT_VALUES, SCATTER_FORWARD));
  const PetscScalar* values = nullptr;
  petsc(VecGetArrayRead(here, &values));
  std::vector<double> at;
  for (std::size_t i = 0; i < static_cast<std::size_t>(size); i += group) at.push_back(values[i]);
  petsc(VecRestoreArrayRead(here, &values));
  return at;
}

// sigma M - K as MUMPS takes it.
OwnedMat shifted(double sigma, const System& system) {
  OwnedMat matrix;
  petsc(MatConvert(system.stiffness, MATAIJ, MAT_INITIAL_MATRIX, matrix.out()));
  petsc(MatScale(matrix, -1));
  if (system.mass) {
    petsc(MatAXPY(matrix, sigma, system.mass, DIFFERENT_NONZERO_PATTERN));
  } else {
    petsc(MatShift(matrix, sigma));
  }
  petsc(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

}  // namespace

DistributedProof::DistributedProof(const System& system, double loss) : system_(system) {
  if (system.size > one_piece) {
    take_own_pieces(loss);
  } else {
    take_part(system, all_for_the_first(system), around_);
    if (rank() == 0) own_.emplace(&around_);
    columns_ = {0, around_.size()};
  }
}

// One exchange: of the numbers of parts, and of rows.
void DistributedProof::take_own_pieces(double loss) {
  const int layers = Pieces::layers_for(loss), group = system_.unknowns_a_node;
  const OwnedIS rows = rows_around(system_, 2 * layers + 1);
  take_part(system_, rows, around_);
  const Graph graph = [&] {
    if (system_.one_pattern) return graph_of(around_.stiffness, group);
    SparseMatrix pattern = around_.stiffness + around_.mass;
    if (around_.has_damping()) pattern = SparseMatrix(pattern + around_.damping);
    return graph_of(pattern, group);
  }();
  const OwnRows own(system_.stiffness);
  PetscInt first = 0;
  petsc(ISLocate(rows, own.first, &first));
  columns_ = {first, first + own.last - own.first};
  const int first_node = first / group, last_node = first_node + (own.last - own.first) / group;
  const std::vector<int> mine = own_parts(graph, first_node, last_node, layers);
  const int count = mine.empty() ? 0 : *std::ranges::max_element(mine) + 1;
  constexpr double most_parts = 1 << 24;  // of a rank
  std::vector<double> names;
  for (const int part : mine) names.push_back(most_parts * rank() + part);
  std::map<double, int> number;  // own parts first
  for (int part = 0; part < count; ++part) number[most_parts * rank() + part] = part;
  std::vector<int> part;
  for (const double name : at_rows(system_, names, rows))
    part.push_back(number.try_emplace(name, static_cast<int>(number.size())).first->second);
  auto pieces = std::make_shared<const Pieces>(graph, part, count, layers);
  pieces_ = pieces->count();
  MPI_Allreduce(MPI_IN_PLACE, &pieces_, 1, MPI_LONG, MPI_SUM, PETSC_COMM_WORLD);
  own_.emplace(around_, std::move(pieces), all_of);
}

bool DistributedProof::holds(double c, double a, double b) {
  if (pieces_ > 0) return own_->holds(c, a, b);
  return told_by_the_first(own_ && own_->holds(c, a, b));
}

double DistributedProof::coupling_ratio() const {
  if (!system_.damping || system_.unknowns_a_node != 3) return 0;
  double ratio = springstab::coupling_ratio(around_, columns_).value_or(0);
  MPI_Allreduce(MPI_IN_PLACE, &ratio, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  return std::isfinite(ratio) ? ratio : 0;
}

std::optional<bool> DistributedProof::stiffness_is_semidefinite() {
  if (pieces_ > 0) return std::nullopt;
  return told_by_the_first(own_ && own_->stiffness_is_semidefinite());
}

std::optional<bool> is_semidefinite(Mat d, const System& system) {
  if (system.size > DistributedProof::one_piece) return std::nullopt;
  const OwnedIS chosen = all_for_the_first(system);
  SparseMatrix all;
  StructuralMatrices s;
  take_part(d, chosen, all);
  take_part(system, chosen, s);
  return told_by_the_first(rank() == 0 && springstab::is_semidefinite(all, s.mass));
}

std::optional<long> eigenvalues_above(double sigma, const System& system) {
  if (system.size > DistributedProof::one_piece) return std::nullopt;
  const OwnedMat matrix = shifted(sigma, system);
  OwnedMat factor;
  PetscBool available = PETSC_FALSE;
  petsc(MatGetFactorAvailable(matrix, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &available));
  if (!available) return std::nullopt;
  petsc(MatGetFactor(matrix, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor.out()));
  petsc(MatMumpsSetIcntl(factor, 24, 1));  // null pivots are told
  petsc(MatMumpsSetIcntl(factor, 13, 1));  // and so are the signs of those of the last front
  MatFactorInfo info;
  petsc(MatFactorInfoInitialize(&info));
  petsc(MatCholeskyFactorSymbolic(factor, matrix, nullptr, &info));
  petsc(MatCholeskyFactorNumeric(factor, matrix, &info));
  PetscInt negative = 0, zero = 0, positive = 0;
  petsc(MatGetInertia(factor, &negative, &zero, &positive));
  return negative;
}

}  // namespace springstab::mpi
