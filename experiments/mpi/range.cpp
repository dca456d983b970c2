#include "experiments/mpi/range.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "experiments/mpi/agreement.h"

namespace springstab::mpi {
namespace {

constexpr int most_restarts = 10'000;

// a D' + b K' as an operator.
struct Sum {
  const System& system;
  double a, b;
  long& products;
  OwnedVec part{};
};

PetscErrorCode multiply(Mat shell, Vec in, Vec out) {
  Sum* sum = nullptr;
  PetscCall(MatShellGetContext(shell, &sum));
  ++sum->products;
  PetscCall(MatMult(sum->system.stiffness, in, out));
  if (sum->b != 1) PetscCall(VecScale(out, sum->b));
  if (sum->a == 0 || !sum->system.damping) return 0;
  PetscCall(MatMult(sum->system.damping, in, sum->part));
  PetscCall(VecAXPY(out, sum->a, sum->part));
  return 0;
}

OwnedMat operator_of(Sum& sum) {
  const OwnRows own(sum.system.stiffness);
  const PetscInt rows = own.last - own.first;
  sum.part = vector_like(sum.system.stiffness);
  OwnedMat shell;
  petsc(MatCreateShell(PETSC_COMM_WORLD, rows, rows, sum.system.size, sum.system.size, &sum, shell.out()));
  petsc(MatShellSetOperation(shell, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  return shell;
}

// Of a number, one in (-1, 1) that is the same on any number of ranks (the finalizer of SplitMix64).
double random_entry(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15U;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9U;
  number = (number ^ (number >> 27)) * 0x94d049bb133111ebU;
  return static_cast<double>((number ^ (number >> 31)) >> 11) * 0x1p-52 - 1;
}

// Random, or near a vector with a little of every other, lest the one sought is orthogonal to it.
OwnedVec start_of(const System& system, std::uint64_t seed, const Eigen::VectorXd& near) {
  OwnedVec start = vector_like(system.stiffness);
  const OwnRows own(system.stiffness);
  PetscScalar* entries = nullptr;
  petsc(VecGetArray(start, &entries));
  for (PetscInt i = own.first; i < own.last; ++i)
    entries[i - own.first] = random_entry((seed << 32) + static_cast<std::uint64_t>(i));
  petsc(VecRestoreArray(start, &entries));
  if (all_of(near.size() == 0)) return start;
  PetscReal norm = 0;
  petsc(VecNorm(start, NORM_2, &norm));
  petsc(VecScale(start, 1e-2 / norm));
  petsc(VecGetArray(start, &entries));
  for (Eigen::Index i = 0; i < near.size(); ++i) entries[i] += near[i];
  petsc(VecRestoreArray(start, &entries));
  return start;
}

Eigen::VectorXd own_entries(Vec v) {
  PetscInt size = 0;
  const PetscScalar* entries = nullptr;
  petsc(VecGetLocalSize(v, &size));
  petsc(VecGetArrayRead(v, &entries));
  Eigen::VectorXd own = Eigen::Map<const Eigen::VectorXd>(entries, size);
  petsc(VecRestoreArrayRead(v, &entries));
  return own;
}

double quadratic_form(Mat a, Vec v) {
  if (!a) return 0;
  const OwnedVec image = vector_like(a);
  petsc(MatMult(a, v, image));
  PetscScalar product = 0;
  petsc(VecDot(v, image, &product));
  return product;
}

// B⁻¹ of a generalized problem by MUMPS, unless the options say otherwise.
void set_mass(EPS eps, Mat mass) {
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  petsc(EPSGetST(eps, &st));
  petsc(STGetKSP(st, &ksp));
  petsc(KSPGetPC(ksp, &pc));
  petsc(MatSetOption(mass, MAT_SPD, PETSC_TRUE));
  petsc(KSPSetType(ksp, KSPPREONLY));
  petsc(PCSetType(pc, PCCHOLESKY));
  petsc(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

}  // namespace

SlepcRange::SlepcRange(const System& system, double tolerance, std::uint64_t seed)
    : system_(system), tolerance_(tolerance), seed_(seed) {}

SlepcRange::Found SlepcRange::search(double a, double b, double tolerance, EPSWhich which,
                                     const Eigen::VectorXd& near) const {
  Sum sum{system_, a, b, products_};
  const OwnedMat shell = operator_of(sum);
  const OwnedVec start = start_of(system_, seed_, near);
  OwnedEps eps;
  petsc(EPSCreate(PETSC_COMM_WORLD, eps.out()));
  petsc(EPSSetOperators(eps, shell, system_.mass));
  petsc(EPSSetProblemType(eps, system_.mass ? EPS_GHEP : EPS_HEP));
  if (system_.mass) set_mass(eps, system_.mass);
  petsc(EPSSetType(eps, EPSKRYLOVSCHUR));
  petsc(EPSSetWhichEigenpairs(eps, which));
  petsc(EPSSetTolerances(eps, std::max(tolerance, tolerance_), most_restarts));
  Vec first = start;
  petsc(EPSSetInitialSpace(eps, 1, &first));
  petsc(EPSSetFromOptions(eps));
  petsc(EPSSolve(eps));
  Found found;
  PetscInt converged = 0;
  petsc(EPSGetConverged(eps, &converged));
  if (converged == 0) return found;
  found.converged = true;
  found.vector = vector_like(system_.stiffness);
  petsc(EPSGetEigenpair(eps, 0, &found.value, nullptr, found.vector, nullptr));
  if (system_.mass) {
    petsc(EPSGetErrorEstimate(eps, 0, &found.residual));  // in the norm of M⁻¹
    found.residual *= std::abs(found.value);
  } else {
    petsc(EPSComputeError(eps, 0, EPS_ERROR_ABSOLUTE, &found.residual));
  }
  double told[2] = {found.value, found.residual};  // one and the same for all, whatever their processors
  MPI_Bcast(told, 2, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  found.value = told[0], found.residual = told[1];
  return found;
}

std::optional<ExtremePoint> SlepcRange::farthest(double a, double b, double tolerance,
                                                 const Eigen::VectorXd& near) const {
  const Found found = search(a, b, tolerance, EPS_LARGEST_REAL, near);
  if (!found.converged) return std::nullopt;
  PetscScalar size = 0;
  if (system_.mass) {
    size = quadratic_form(system_.mass, found.vector);
  } else {
    petsc(VecDot(found.vector, found.vector, &size));
  }
  const double d = quadratic_form(system_.damping, found.vector) / size,
               k = quadratic_form(system_.stiffness, found.vector) / size;
  return ExtremePoint{{d, k}, own_entries(found.vector) / std::sqrt(size)};
}

StiffestMode SlepcRange::stiffest_mode() const {
  const long before = products_;
  const Found found = search(0, 1, tolerance_, EPS_LARGEST_REAL, {});
  StiffestMode mode;
  mode.converged = found.converged;
  mode.value = found.value;
  mode.residual = found.residual;
  mode.products = products_ - before;
  mode.upper_bound = infinity;
  if (system_.mass) return mode;
  PetscReal row_sum = 0;
  petsc(MatNorm(system_.stiffness, NORM_INFINITY, &row_sum));
  mode.gershgorin = row_sum * (1 + 8 * unit_roundoff * static_cast<double>(system_.size));
  mode.upper_bound = mode.gershgorin;
  return mode;
}

std::optional<double> SlepcRange::lowest() const {
  const Found found = search(0, 1, tolerance_, EPS_SMALLEST_REAL, {});
  return found.converged ? std::optional(found.value) : std::nullopt;
}

}  // namespace springstab::mpi
