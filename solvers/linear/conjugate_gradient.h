// Conjugate gradients for H y = b, H symmetric positive definite, from y = 0.
// (Hestenes & Stiefel 1952; Saad, Iterative Methods for Sparse Linear Systems, Alg. 9.1.)
// H and the preconditioner are operators; the workspace is kept from solve to solve.
#pragma once

#include <cmath>
#include <numeric>
#include <vector>

#include "solvers/linear/solver_options.h"
#include "solvers/step_by_rows.h"
#include "solvers/system.h"
#include "solvers/team.h"

namespace springstab {

class ConjugateGradient {
 public:
  /// apply(p, out): out = H p, returns pᵀHp. precondition(range, r, z): z = P⁻¹ r for those numbers, returns
  /// the range's share of rᵀP⁻¹r, P symmetric positive definite and of blocks that divide 12; out and z have
  /// the size of b. Negative curvature (pᵀHp <= 0) is reported as not_positive_definite, not averaged away.
  template <class Apply, class Precondition>
  SolveReport solve(const Apply& apply, const Precondition& precondition, const Vector& b, Vector& y,
                    const SolverOptions& options) {
    return iterate(apply, precondition, z_, b, y, options);
  }

  /// Without a preconditioner: P = 1.
  template <class Apply>
  SolveReport solve(const Apply& apply, const Vector& b, Vector& y, const SolverOptions& options) {
    return iterate(
        apply,
        [](const IndexRange& range, const Vector& r, const Vector&) {
          return r.segment(range.first, range.last - range.first).squaredNorm();
        },
        r_, b, y, options);
  }

 private:
  // Numbers that are gone through together, while they are in the first cache; also those that are summed up
  // by themselves, so that sums do not depend on the number of threads.
  static constexpr long piece = 1020;

  // z is P⁻¹ r after precondition(range, r, z) for all; without a preconditioner it is r itself.
  template <class Apply, class Precondition>
  SolveReport iterate(const Apply& apply, const Precondition& precondition, Vector& z, const Vector& b,
                      Vector& y, const SolverOptions& options) {
    SolveReport report;
    for (Vector* u : {&r_, &z, &p_, &q_}) u->resize(b.size());
    y.setZero(b.size());
    r_ = b;
    double rho = sum_over_pieces([&](const IndexRange& range) { return precondition(range, r_, z); });
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
      const double next = sum_over_pieces([&](const IndexRange& range) {
        const auto at = entries(range);
        at(y) += step * at(p_);
        at(r_) -= step * at(q_);
        return precondition(range, r_, z);
      });
      for_pieces([&](long, const IndexRange& range) {
        const auto at = entries(range);
        at(p_) = at(z) + (next / rho) * at(p_);
      });
      rho = next;
    }
    if (!std::isfinite(rho)) report.status = StepStatus::diverged;
    return report;
  }

  long pieces() const { return (r_.size() + piece - 1) / piece; }

  template <class Work>
  void for_pieces(const Work& work) const {
    constexpr double cost = 800;  // of a piece, about [ns]
    const long n = r_.size();
    share_range(pieces(), cost, [&](long first, long last) {
      for (long i = first; i < last; ++i) work(i, IndexRange{i * piece, std::min(n, (i + 1) * piece)});
    });
  }

  template <class Term>
  double sum_over_pieces(const Term& term) {
    sums_.resize(static_cast<std::size_t>(pieces()));
    for_pieces([&](long i, const IndexRange& range) { sums_[i] = term(range); });
    return std::accumulate(sums_.begin(), sums_.end(), 0.0);
  }

  Vector r_, z_, p_, q_;
  std::vector<double> sums_;  // of each piece
};

}  // namespace springstab
