#include "analysis/spectra/numerical_range.h"

#include <algorithm>
#include <cmath>

#include "analysis/constants.h"
#include "analysis/spectra/chebyshev_filter.h"
#include "analysis/spectra/lanczos.h"
#include "analysis/spectra/spectrum.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

// The least eigenvalue of `factor` times a.
double lowest(double factor, const LinearOperator& a) {
  return factor == 0 ? 0 : factor > 0 ? factor * a.lowest : factor * a.highest;
}

}  // namespace

NumericalRange::NumericalRange(const StructuralMatrices& s, ArpackOptions options)
    : size_(s.size()), options_(std::move(options)), stiffness_(mass_scaled(s.stiffness, s.mass)) {
  if (s.has_damping()) {
    damping_ = mass_scaled(s.damping, s.mass);
  } else {
    damping_ = {size_, [](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out.setZero(in.size()); }, 0, 0};
  }
  if (size_ >= many_unknowns && is_diagonal(s.mass)) {
    const Eigen::VectorXd d = s.mass.diagonal().cwiseSqrt().cwiseInverse();
    sparse_stiffness_ = scaled(s.stiffness, d);
    if (s.has_damping()) {  // both with the entries of either, for sums entry by entry
      sparse_damping_ = scaled(s.damping, d);
      sparse_stiffness_ = SparseMatrix(sparse_stiffness_ + 0 * sparse_damping_);
      sparse_damping_ = SparseMatrix(sparse_damping_ + 0 * sparse_stiffness_);
    }
  }
  if (size_ > dense_limit) return;
  dense_damping_ = symmetric_part(as_dense(damping_));
  dense_stiffness_ = symmetric_part(as_dense(stiffness_));
}

ExtremePoint NumericalRange::point(const Eigen::VectorXd& v) const {
  Eigen::VectorXd image;
  damping_.apply(v, image);
  const double d = v.dot(image);
  stiffness_.apply(v, image);
  return {{d, v.dot(image)}, v};
}

// a D' + b K', shifted to a positive semidefinite one, where a bound is known: the largest eigenvalue may be
// 0, and the null space is hidden from ARPACK, which multiplies even its start vector by the operator.
LinearOperator NumericalRange::sum(double a, double b) const {
  const double bound = lowest(a, damping_) + lowest(b, stiffness_);
  const double shift = std::isfinite(bound) ? -bound : 0;
  if (sparse_stiffness_.size() > 0) {
    SparseMatrix matrix = sparse_stiffness_;
    matrix.coeffs() *= b;
    if (sparse_damping_.size() > 0) matrix.coeffs() += a * sparse_damping_.coeffs();
    LinearOperator op = symmetric_operator(std::move(matrix));
    const auto apply = std::move(op.apply);
    op.apply = [apply, shift](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
      apply(in, out);
      out += shift * in;
    };
    op.lowest = bound + shift;
    return op;
  }
  return {
      size_,
      [this, a, b, shift, part = Eigen::VectorXd()](const Eigen::VectorXd& in, Eigen::VectorXd& out) mutable {
        stiffness_.apply(in, out);
        damping_.apply(in, part);
        out = b * out + a * part + shift * in;
      },
      bound + shift};
}

std::optional<ExtremePoint> NumericalRange::farthest(double a, double b, double tolerance,
                                                     const Eigen::VectorXd& near) const {
  std::optional<Axis>* const axis = size_ < many_unknowns ? nullptr
                                    : a == 0 && b > 0     ? &stiffest_
                                    : b == 0 && a > 0     ? &most_damped_
                                                          : nullptr;
  if (!axis) return search(a, b, tolerance, near);
  if (!*axis || (*axis)->tolerance > tolerance) {
    const std::optional<ExtremePoint> found = search(a, b, tolerance, *axis ? (*axis)->point.vector : near);
    if (!found) return std::nullopt;
    *axis = {*found, tolerance};
  }
  return (*axis)->point;
}

std::optional<ExtremePoint> NumericalRange::search(double a, double b, double tolerance,
                                                   const Eigen::VectorXd& near) const {
  if (size_ <= dense_limit) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        Eigen::MatrixXd(a * dense_damping_ + b * dense_stiffness_));
    if (solver.info() != Eigen::Success) return std::nullopt;
    return point(solver.eigenvectors().rightCols<1>());
  }
  const LinearOperator matrix = sum(a, b);
  ArpackOptions options = options_;
  options.tolerance = std::max(options.tolerance, tolerance);
  if (near.size() > 0) {  // with a little of every other vector, lest the largest is orthogonal to it
    const Eigen::VectorXd random = start_vector(size_, {}, options_.seed);
    options.start = near + 1e-2 / random.norm() * random;
  }
  SymmetricEigenpairs pairs;
  if (size_ >= many_unknowns && options.tolerance >= lanczos_tolerance)
    pairs = largest_by_lanczos(matrix, options, true);
  if (!pairs.converged) pairs = largest_eigenpair(matrix, options);
  if (!pairs.converged) return std::nullopt;
  return point(pairs.vectors.col(0));
}

}  // namespace springstab
