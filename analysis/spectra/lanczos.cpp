#include "analysis/spectra/lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/constants.h"

namespace springstab {
namespace {

// T v_j = β_{j-1} v_{j-1} + α_j v_j + β_j v_{j+1} of A/scale, about of unit size; a power of two, so that
// nothing is rounded. Passes over vectors count here: a product of a flat net costs no more than five of
// them.
class Recurrence {
 public:
  Recurrence(const LinearOperator& a, const Eigen::VectorXd& start)
      : a_(a), before_(Eigen::VectorXd::Zero(start.size())), now_(start.normalized()) {}

  const Eigen::VectorXd& now() const { return now_; }
  double scale() const { return scale_; }

  // β_j; the vector v_{j+1} is now, unless that is 0.
  double step(double& alpha) {
    a_.apply(now_, product_);
    if (beta_ < 0) set_scale();
    image_ = product_ / scale_ - std::max(beta_, 0.0) * before_;
    alpha = image_.dot(now_);
    if (!std::isfinite(alpha))
      throw std::invalid_argument("the operator's product is not finite, expected finite matrices");
    image_ -= alpha * now_;
    beta_ = image_.norm();
    before_.swap(now_);
    if (beta_ > 0) now_ = image_ / beta_;
    return beta_;
  }

 private:
  void set_scale() {
    const double size = product_.cwiseAbs().maxCoeff();
    if (std::isfinite(size) && size > 0) scale_ = std::exp2(std::ilogb(size / now_.cwiseAbs().maxCoeff()));
  }

  const LinearOperator& a_;
  Eigen::VectorXd before_, now_, product_, image_;
  double beta_ = -1, scale_ = 1;  // before the first step
};

double largest_eigenvalue(const std::vector<double>& alpha, const std::vector<double>& beta) {
  const auto n = static_cast<Eigen::Index>(alpha.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(alpha.data(), n),
                                Eigen::Map<const Eigen::VectorXd>(beta.data(), n - 1),
                                Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[n - 1];
}

// The eigenvector of the largest eigenvalue, by inverse iteration from a little above it, where T - shift is
// negative definite and its elimination needs no pivots.
Eigen::VectorXd top_vector(const std::vector<double>& alpha, const std::vector<double>& beta, double theta) {
  const auto n = static_cast<Eigen::Index>(alpha.size());
  const double shift = theta + 16 * unit_roundoff * (std::abs(theta) + 1);
  Eigen::VectorXd pivot(n), s = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i)
    pivot[i] = std::min(alpha[i] - shift - (i > 0 ? beta[i - 1] * beta[i - 1] / pivot[i - 1] : 0),
                        -unit_roundoff * unit_roundoff);
  for (int again = 0; again < 3; ++again) {
    for (Eigen::Index i = 1; i < n; ++i) s[i] -= beta[i - 1] / pivot[i - 1] * s[i - 1];
    s = s.cwiseQuotient(pivot).eval();
    for (Eigen::Index i = n - 2; i >= 0; --i) s[i] -= beta[i] / pivot[i] * s[i + 1];
    s /= s.cwiseAbs().maxCoeff();
    s.normalize();
  }
  return s;
}

}  // namespace

SymmetricEigenpairs largest_by_lanczos(const LinearOperator& a, const ArpackOptions& options,
                                       bool with_vector, Eigen::Index most_kept) {
  const Eigen::VectorXd start = start_vector(a.size, options.start, options.seed);
  const auto most = static_cast<std::size_t>(40 / std::sqrt(options.tolerance));
  std::vector<double> alpha, beta;
  std::vector<Eigen::VectorXd> kept;  // the basis, where that is small enough
  bool keeps = with_vector;
  Eigen::VectorXd weights;
  SymmetricEigenpairs found;
  double theta = 0, residual = 0;
  Recurrence forth(a, start);
  for (std::size_t next = 8; alpha.size() < most && !found.converged;) {
    if (keeps && std::ssize(kept) * a.size >= most_kept) keeps = false, kept = {};  // of no use in part
    if (keeps) kept.push_back(forth.now());
    beta.push_back(forth.step(alpha.emplace_back()));
    if (alpha.size() < next && beta.back() > 0) continue;
    next = alpha.size() + alpha.size() / 8;
    theta = largest_eigenvalue(alpha, beta);
    weights = top_vector(alpha, beta, theta);
    residual = beta.back() * std::abs(weights[weights.size() - 1]);
    found.converged = residual <= options.tolerance * std::abs(theta) || beta.back() == 0;
    if (beta.back() == 0) break;
  }
  found.products = std::ssize(alpha);
  if (!found.converged) return found;
  found.values = {forth.scale() * theta};
  found.residuals = {forth.scale() * residual};
  if (!with_vector) return found;
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(a.size);
  if (keeps) {
    for (Eigen::Index i = 0; i < weights.size(); ++i)
      vector += weights[i] * kept[static_cast<std::size_t>(i)];
  } else {
    Recurrence again(a, start);
    double ignored = 0;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      if (i > 0) again.step(ignored), ++found.products;
      vector += weights[i] * again.now();
    }
  }
  found.vectors = vector.normalized();
  return found;
}

}  // namespace springstab
