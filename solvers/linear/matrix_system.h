// A linear system given by its matrices: M x'' = -K x - D v, for structures read from files.
//
//     MatrixSystem system(prepare(stiffness, mass));
//     State<Vector> state{Vector::Ones(system.size()), Vector::Zero(system.size())};
//     make_stepper(ImplicitEuler())->step(system, 0.01, state);
#pragma once

#include <memory>

#include "solvers/linear/structural_matrices.h"
#include "solvers/system.h"

namespace springstab {

/// Where K or D is not symmetric an implicit step throws std::invalid_argument.
/// Solves with M and with mM + dD + kK by sparse Cholesky factors; the latter is kept while the shift stays
/// the same.
class MatrixSystem final : public LinearSystem {
 public:
  explicit MatrixSystem(StructuralMatrices matrices);
  ~MatrixSystem() override;

  const StructuralMatrices& matrices() const { return matrices_; }

  Eigen::Index size() const override { return matrices_.size(); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override;
  void stiffness_times(const Vector& u, Vector& out) override;
  void damping_times(const Vector& u, Vector& out) override;
  SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) override;
  /// Takes K and D that are not symmetric, too.
  SolveReport solve_coupled(const StageCoupling& coupling, const std::vector<Vector>& rhs,
                            std::vector<Vector>& out) override;
  SolveReport solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) override;
  double kinetic_energy(const Vector& v) override;
  double potential_energy(const Vector& x) override;

 private:
  struct Factors;

  SolveReport solve_factored(const Vector& rhs, Vector& out);

  StructuralMatrices matrices_;
  std::unique_ptr<Factors> factors_;
  Vector force_;
};

}  // namespace springstab
