// Conjugate gradients for H y = b, H symmetric positive definite, from y = 0.
// (Hestenes & Stiefel 1952; Saad, Iterative Methods for Sparse Linear Systems, Alg. 9.1.)
// H and the preconditioner are operators; the workspace is kept from solve to solve.
#pragma once

#include <cmath>

#include "solvers/linear/solver_options.h"
#include "solvers/system.h"

namespace springstab {

class ConjugateGradient {
 public:
  /// apply(p, out): out = H p, returns pᵀHp. precondition(r, out): out = P⁻¹ r, returns rᵀP⁻¹r, P symmetric
  /// positive definite. Negative curvature (pᵀHp <= 0) is reported as not_positive_definite, not averaged
  /// away.
  template <class Apply, class Precondition>
  SolveReport solve(const Apply& apply, const Precondition& precondition, const Vector& b, Vector& y,
                    const SolverOptions& options) {
    return iterate(apply, precondition, z_, b, y, options);
  }

  /// Without a preconditioner: P = 1.
  template <class Apply>
  SolveReport solve(const Apply& apply, const Vector& b, Vector& y, const SolverOptions& options) {
    return iterate(
        apply, [](const Vector& r, const Vector&) { return r.squaredNorm(); }, r_, b, y, options);
  }

 private:
  // z is P⁻¹ r after precondition(r, z); without a preconditioner it is r itself.
  template <class Apply, class Precondition>
  SolveReport iterate(const Apply& apply, const Precondition& precondition, Vector& z, const Vector& b,
                      Vector& y, const SolverOptions& options) {
    SolveReport report;
    y.setZero(b.size());
    r_ = b;
    double rho = precondition(r_, z);
    if (rho == 0) return report;
    p_ = z;
    const double goal = options.tolerance * options.tolerance * rho;
    while (rho > goal) {
      if (report.iterations == options.max_iterations)
        return report.status = StepStatus::not_converged, report;
      const double curvature = apply(p_, q_);
      ++report.iterations;
      if (!std::isfinite(curvature)) return report.status = StepStatus::diverged, report;
      if (curvature <= 0) return report.status = StepStatus::not_positive_definite, report;
      const double step = rho / curvature;
      y += step * p_;
      r_ -= step * q_;
      const double next = precondition(r_, z);
      p_ = z + (next / rho) * p_;
      rho = next;
    }
    if (!std::isfinite(rho)) report.status = StepStatus::diverged;
    return report;
  }

  Vector r_, z_, p_, q_;
};

}  // namespace springstab
