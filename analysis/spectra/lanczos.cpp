#include "analysis/spectra/lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/constants.h"

namespace springstab {
namespace {

// A/scale, about of unit size; a power of two, so that nothing is rounded.
class ScaledProduct {
 public:
  explicit ScaledProduct(const LinearOperator& a) : a_(a) {}

  void operator()(const Eigen::VectorXd& in, Eigen::VectorXd& out) {
    a_.apply(in, out);
    ++products_;
    const double size = out.cwiseAbs().maxCoeff();
    if (!std::isfinite(size))
      throw std::invalid_argument("the operator's product is not finite, expected finite matrices");
    if (products_ == 1 && size > 0) scale_ = std::exp2(std::ilogb(size / in.cwiseAbs().maxCoeff()));
    out /= scale_;
  }
  double scale() const { return scale_; }
  long products() const { return products_; }

 private:
  const LinearOperator& a_;
  double scale_ = 1;
  long products_ = 0;
};

// T v_j = β_{j-1} v_{j-1} + α_j v_j + β_j v_{j+1}.
struct Recurrence {
  Eigen::VectorXd before, now, image;
  double beta = 0;

  explicit Recurrence(const Eigen::VectorXd& start)
      : before(Eigen::VectorXd::Zero(start.size())), now(start.normalized()) {}

  // β_j; the vector v_{j+1} is now, unless that is 0.
  double step(ScaledProduct& product, double& alpha) {
    product(now, image);
    image -= beta * before;
    alpha = image.dot(now);
    image -= alpha * now;
    beta = image.norm();
    before.swap(now);
    if (beta > 0) now = image / beta;
    return beta;
  }
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
                                       bool with_vector) {
  const Eigen::VectorXd start = start_vector(a.size, options.start, options.seed);
  const auto most = static_cast<std::size_t>(40 / std::sqrt(options.tolerance));
  ScaledProduct product(a);
  std::vector<double> alpha, beta;
  Eigen::VectorXd weights;
  SymmetricEigenpairs found;
  double theta = 0, residual = 0;
  Recurrence forth(start);
  for (std::size_t next = 8; alpha.size() < most && !found.converged;) {
    beta.push_back(forth.step(product, alpha.emplace_back()));
    if (alpha.size() < next && beta.back() > 0) continue;
    next = alpha.size() + alpha.size() / 8;
    theta = largest_eigenvalue(alpha, beta);
    weights = top_vector(alpha, beta, theta);
    residual = beta.back() * std::abs(weights[weights.size() - 1]);
    found.converged = residual <= options.tolerance * std::abs(theta) || beta.back() == 0;
    if (beta.back() == 0) break;
  }
  found.products = product.products();
  if (!found.converged) return found;
  found.values = {product.scale() * theta};
  found.residuals = {product.scale() * residual};
  if (!with_vector) return found;
  Recurrence again(start);
  Eigen::VectorXd vector = weights[0] * again.now;
  double ignored = 0;
  for (Eigen::Index i = 1; i < weights.size(); ++i) {
    again.step(product, ignored);
    vector += weights[i] * again.now;
  }
  found.vectors = vector.normalized();
  found.products = product.products();
  return found;
}

}  // namespace springstab
