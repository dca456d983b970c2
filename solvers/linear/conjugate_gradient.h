// Preconditioned conjugate gradients for H y = b, H symmetric positive definite, from y = 0.
// (Hestenes & Stiefel 1952; Saad, Iterative Methods for Sparse Linear Systems, Alg. 9.1.)
// H and the preconditioner are operators; the workspace is kept from solve to solve.
#pragma once

#include <cmath>

#include "solvers/system.h"

namespace springstab {

struct ConjugateGradientOptions {
  double tolerance = 1e-6;  // on ‖b - Hy‖ in the preconditioner's norm, relative to that of b
  long max_iterations = 10000;
};

class ConjugateGradient {
 public:
  /// apply(p, out): out = H p. precondition(r, out): out = P⁻¹ r, P symmetric positive definite.
  /// Negative curvature (pᵀHp <= 0) is reported as not_positive_definite, not averaged away.
  template <class Apply, class Precondition>
  SolveReport solve(const Apply& apply, const Precondition& precondition, const Vector& b, Vector& y,
                    const ConjugateGradientOptions& options) {
    SolveReport report;
    y.setZero(b.size());
    r_ = b;
    precondition(r_, z_);
    double rho = r_.dot(z_);
    if (rho == 0) return report;
    p_ = z_;
    const double goal = options.tolerance * options.tolerance * rho;
    while (rho > goal) {
      if (report.iterations == options.max_iterations)
        return report.status = StepStatus::not_converged, report;
      apply(p_, q_);
      ++report.iterations;
      const double curvature = p_.dot(q_);
      if (!std::isfinite(curvature)) return report.status = StepStatus::diverged, report;
      if (curvature <= 0) return report.status = StepStatus::not_positive_definite, report;
      const double step = rho / curvature;
      y += step * p_;
      r_ -= step * q_;
      precondition(r_, z_);
      const double next = r_.dot(z_);
      p_ = z_ + (next / rho) * p_;
      rho = next;
    }
    if (!std::isfinite(rho)) report.status = StepStatus::diverged;
    return report;
  }

 private:
  Vector r_, z_, p_, q_;
};

}  // namespace springstab
