#include "solvers/linear/matrix_system.h"

#include <Eigen/SparseCholesky>
#include <optional>
#include <stdexcept>

#include "solvers/linear/coupled_stages.h"

namespace springstab {

struct MatrixSystem::Factors {
  Eigen::SimplicialLLT<SparseMatrix> mass, shifted;
  std::optional<Shift> shift;                             // of `shifted`, or
  std::optional<std::pair<DampingPart, double>> damping;  // M + hD_i of that part and h
  CoupledStages coupled;
};

MatrixSystem::MatrixSystem(StructuralMatrices matrices)
    : matrices_(std::move(matrices)), factors_(std::make_unique<Factors>()) {
  factors_->mass.compute(matrices_.mass);
}

MatrixSystem::~MatrixSystem() = default;

void MatrixSystem::acceleration(const Vector& x, const Vector& v, Vector& out) {
  force_.noalias() = -(matrices_.stiffness * x);
  if (matrices_.has_damping()) force_.noalias() -= matrices_.damping * v;
  out = factors_->mass.solve(force_);
}

void MatrixSystem::stiffness_times(const Vector& u, Vector& out) {
  force_.noalias() = matrices_.stiffness * u;
  out = factors_->mass.solve(force_);
}

void MatrixSystem::damping_times(const Vector& u, Vector& out) {
  out.setZero(size());
  if (!matrices_.has_damping()) return;
  force_.noalias() = matrices_.damping * u;
  out = factors_->mass.solve(force_);
}

SolveReport MatrixSystem::solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) {
  if (factors_->shift != shift) {
    SparseMatrix shifted = shift.mass * matrices_.mass + shift.stiffness * matrices_.stiffness;
    if (matrices_.has_damping()) shifted += shift.damping * matrices_.damping;
    factors_->shifted.compute(shifted);
    factors_->shift = shift;
    factors_->damping.reset();
  }
  return solve_factored(rhs, out);
}

SolveReport MatrixSystem::solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) {
  if (part == DampingPart::all && !matrices_.says_implicit()) return solve_shifted({1, h, 0}, rhs, out);
  if (const std::pair wanted(part, h); factors_->damping != wanted) {
    factors_->shifted.compute(matrices_.mass + h * implicit_damping(matrices_, part));
    factors_->damping = wanted;
    factors_->shift.reset();
  }
  return solve_factored(rhs, out);
}

SolveReport MatrixSystem::solve_factored(const Vector& rhs, Vector& out) {
  if (!matrices_.symmetric)
    throw std::invalid_argument("K or D is not symmetric, expected symmetric ones for an implicit step");
  if (factors_->shifted.info() != Eigen::Success) return {.status = StepStatus::not_positive_definite};
  force_.noalias() = matrices_.mass * rhs;
  out = factors_->shifted.solve(force_);
  return {};
}

SolveReport MatrixSystem::solve_coupled(const StageCoupling& coupling, const std::vector<Vector>& rhs,
                                        std::vector<Vector>& out) {
  if (!factors_->coupled.is_factorized(coupling)) factors_->coupled.factorize(coupling, matrices_);
  return factors_->coupled.solve(matrices_.mass, rhs, out);
}

double MatrixSystem::kinetic_energy(const Vector& v) { return v.dot(matrices_.mass * v) / 2; }

double MatrixSystem::potential_energy(const Vector& x) { return x.dot(matrices_.stiffness * x) / 2; }

}  // namespace springstab
