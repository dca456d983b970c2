// Systems of matrices from files, by rows.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiments/mpi/agreement.h"
#include "experiments/mpi/matrix_rows.h"
#include "experiments/mpi/proof.h"
#include "experiments/mpi/system.h"

namespace springstab::mpi {
namespace {

bool is_diagonal(Mat a) {
  const OwnRows own(a);
  bool diagonal = true;
  for (PetscInt i = own.first; i < own.last && diagonal; ++i) {
    const Row row(a, i);
    for (int k = 0; k < row.size(); ++k) diagonal = diagonal && (row.column(k) == i || row.value(k) == 0);
  }
  return all_of(diagonal);
}

// v_i <- f(v_i)
template <class Function>
void apply(Vec v, const Function& f) {
  PetscInt size = 0;
  PetscScalar* entries = nullptr;
  petsc(VecGetLocalSize(v, &size));
  petsc(VecGetArray(v, &entries));
  for (PetscInt i = 0; i < size; ++i) entries[i] = f(entries[i]);
  petsc(VecRestoreArray(v, &entries));
}

void check_masses(Mat mass) {
  const OwnRows own(mass);
  const OwnedVec diagonal = diagonal_of(mass);
  const PetscScalar* m = nullptr;
  petsc(VecGetArrayRead(diagonal, &m));
  together([&] {
    for (PetscInt i = 0; i < own.last - own.first; ++i) {
      if (m[i] > 0) continue;
      std::ostringstream message;
      message << "the mass of unknown " << own.first + i + 1 << " is " << m[i]
              << ", expected a positive one (springstab limits eliminates unknowns without mass)";
      throw std::invalid_argument(message.str());
    }
  });
  petsc(VecRestoreArrayRead(diagonal, &m));
}

// Σ a_ij b_ij
double frobenius_product(Mat a, Mat b) {
  const OwnRows own(a);
  double sum = 0;
  for (PetscInt i = own.first; i < own.last; ++i) {
    const Row p(a, i), q(b, i);
    for (int k = 0, l = 0; k < p.size() && l < q.size();) {
      if (p.column(k) == q.column(l))
        sum += p.value(k++) * q.value(l++);
      else if (p.column(k) < q.column(l))
        ++k;
      else
        ++l;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return sum;
}

double norm(Mat a) {
  PetscReal size = 0;
  petsc(MatNorm(a, NORM_FROBENIUS, &size));
  return size;
}

OwnedMat unit_matrix(Mat like) {
  OwnedMat unit = copy_of(like);
  const OwnedVec ones = vector_like(like);
  petsc(VecSet(ones, 1));
  petsc(MatZeroEntries(unit));
  petsc(MatDiagonalSet(unit, ones, INSERT_VALUES));
  return unit;
}

OwnedMat scaled_copy(Mat a, Vec d) {
  OwnedMat copy = copy_of(a);
  scale(copy, d);
  return copy;
}

// Whether no entry of D - d0 M - alpha K is larger than the tolerance times √(size_i size_j), where size_i is
// what the three have on the diagonal. The matrices in units in which D has a unit diagonal.
bool fits(Mat k, Mat m, Mat d, const DampingModel& fit) {
  OwnedMat rest = copy_of(d);
  petsc(MatAXPY(rest, -fit.d0, m, DIFFERENT_NONZERO_PATTERN));
  petsc(MatAXPY(rest, -fit.alpha, k, DIFFERENT_NONZERO_PATTERN));
  const OwnedVec size = diagonal_of(d), part = diagonal_of(m);
  petsc(VecAbs(size));
  petsc(VecAXPY(size, fit.d0, part));
  petsc(MatGetDiagonal(k, part));
  petsc(VecAbs(part));
  petsc(VecAXPY(size, fit.alpha, part));
  apply(size, [](double s) { return s > 0 ? 1 / std::sqrt(s) : 1; });
  scale(rest, size);
  const OwnedVec largest = vector_like(rest);
  petsc(MatGetRowMaxAbs(rest, largest, nullptr));
  PetscReal most = 0;
  petsc(VecMax(largest, nullptr, &most));
  return most <= rayleigh_tolerance;
}

// Rayleigh's where it is, as classify_damping finds it (analysis/limits/structure.h).
DampingModel model_of(const System& s) {
  OwnedVec root = diagonal_of(s.damping);
  apply(root, [](double d) { return d > 0 ? 1 / std::sqrt(d) : 1; });  // M has a unit diagonal
  const OwnedMat k = scaled_copy(s.stiffness, root), d = scaled_copy(s.damping, root),
                 m = s.mass ? scaled_copy(s.mass, root) : scaled_copy(unit_matrix(s.stiffness), root);
  const auto fit = rayleigh_fit(
      {norm(m), norm(k), norm(d), frobenius_product(m, k), frobenius_product(d, m), frobenius_product(d, k)});
  if (fit && fits(k, m, d, *fit)) return *fit;
  return {DampingModel::Kind::general, 0, 0, is_semidefinite(s.damping, s).value_or(true)};
}

void scale_by_mass(System& s) {
  OwnedVec root = diagonal_of(s.mass);
  apply(root, [](double m) { return 1 / std::sqrt(m); });
  scale(s.stiffness, root);
  if (s.damping) scale(s.damping, root);
  if (is_diagonal(s.mass)) {
    s.mass = {};
  } else {
    scale(s.mass, root);
  }
}

// D' + d0 M' + alpha K'
void add_rayleigh(const RayleighDamping& more, System& s) {
  petsc(MatAXPY(s.damping, more.alpha, s.stiffness, DIFFERENT_NONZERO_PATTERN));
  if (s.mass) {
    petsc(MatAXPY(s.damping, more.d0, s.mass, DIFFERENT_NONZERO_PATTERN));
  } else {
    petsc(MatShift(s.damping, more.d0));
  }
}

}  // namespace

System matrix_system(const InputOptions& options) {
  const Duplicates duplicates = options.sum_duplicates ? Duplicates::summed : Duplicates::refused;
  System s;
  s.one_pattern = options.mass.empty() && options.damping_matrix.empty();
  RayleighDamping more;
  together([&] { more = rayleigh_of(options); });
  s.stiffness = read_symmetric_rows(options.stiffness, "stiffness", 0, duplicates);
  petsc(MatGetSize(s.stiffness, &s.size, nullptr));
  if (!options.damping_matrix.empty())
    s.damping = read_symmetric_rows(options.damping_matrix, "damping", s.size, duplicates);
  if (!options.mass.empty()) {
    s.mass = read_symmetric_rows(options.mass, "mass", s.size, duplicates);
    check_masses(s.mass);
    scale_by_mass(s);
  }
  const bool rayleigh = more.d0 != 0 || more.alpha != 0;
  if (s.damping) {
    if (rayleigh) add_rayleigh(more, s);
    s.model = model_of(s);
    if (s.model.kind != DampingModel::Kind::general) s.damping = {};
  } else if (rayleigh) {
    s.model = {DampingModel::Kind::rayleigh, more.d0, more.alpha};
  }
  return s;
}

System read_system(const InputOptions& options) {
  if (!options.stiffness.empty()) return matrix_system(options);
  SceneDescription description;
  together([&] { description = describe(options); });
  return scene_system(description);
}

}  // namespace springstab::mpi
