#include "analysis/spectra/eigenvalue_refinement.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "analysis/constants.h"

namespace springstab {
namespace {

using ComplexVector = Eigen::VectorXcd;

constexpr int most_iterations = 12;
constexpr double settled = 1e-12;
constexpr double beside_it = 1 + 1e-12;  // where P(μ) has an inverse

/// An unevaluated sum of two doubles: twice the precision (Dekker 1971, Knuth's sum).
struct Twice {
  double high = 0, low = 0;

  void add(double a) {
    const double sum = high + a, rest = sum - high;
    low += (high - (sum - rest)) + (a - rest);
    high = sum;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(product);
    low += std::fma(a, b, -product);
  }
  void add_product(double a, const Twice& b) {
    add_product(a, b.high);
    low += a * b.low;
  }
  double value() const { return high + low; }
  Twice normalized() const { return {high + low, low - ((high + low) - high)}; }
};

struct TwiceComplex {
  Twice real, imag;

  void add_product(double a, const TwiceComplex& b) {
    real.add_product(a, b.real);
    imag.add_product(a, b.imag);
  }
};

// μ z.
TwiceComplex times(std::complex<double> mu, const TwiceComplex& z) {
  TwiceComplex p;
  p.real.add_product(mu.real(), z.real);
  p.real.add_product(-mu.imag(), z.imag);
  p.imag.add_product(mu.real(), z.imag);
  p.imag.add_product(mu.imag(), z.real);
  return {p.real.normalized(), p.imag.normalized()};
}

// A power of two near x.
double power_of_two(double x) { return std::exp2(std::round(std::log2(x))); }

double sum_of_terms(const Eigen::MatrixXd& a, const ComplexVector& y, const ComplexVector& x) {
  return y.cwiseAbs().dot(a.cwiseAbs() * x.cwiseAbs());
}

// P(μ) x.
ComplexVector residual(const Eigen::MatrixXd& m, const Eigen::MatrixXd& d, const Eigen::MatrixXd& k,
                       std::complex<double> mu, const ComplexVector& x) {
  const Eigen::Index n = x.size();
  std::vector<TwiceComplex> x0(n), x1(n), x2(n), sum(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    x0[j] = {{x[j].real()}, {x[j].imag()}};
    x1[j] = times(mu, x0[j]);
    x2[j] = times(mu, x1[j]);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (k(i, j) != 0) sum[i].add_product(k(i, j), x0[j]);
      if (d(i, j) != 0) sum[i].add_product(d(i, j), x1[j]);
      if (m(i, j) != 0) sum[i].add_product(m(i, j), x2[j]);
    }
  }
  ComplexVector r(n);
  for (Eigen::Index i = 0; i < n; ++i) r[i] = {sum[i].real.value(), sum[i].imag.value()};
  return r;
}

}  // namespace

EigenvalueRefinement::EigenvalueRefinement(const StructuralMatrices& s, double rate)
    : rate_(power_of_two(rate)), symmetric_(s.symmetric) {
  Eigen::VectorXd root = Eigen::VectorXd(s.mass.diagonal()).cwiseSqrt().cwiseInverse();
  for (double& entry : root) entry = power_of_two(entry);
  mass_ = scaled(s.mass, root);
  stiffness_ = scaled(s.stiffness, root) / (rate_ * rate_);
  damping_ = Eigen::MatrixXd::Zero(s.size(), s.size());
  if (s.has_damping()) damping_ = scaled(s.damping, root) / rate_;
}

bool EigenvalueRefinement::is_rigid(const Eigen::VectorXcd& x, const Eigen::VectorXcd& y) const {
  const double round_off = 4 * unit_roundoff * static_cast<double>(x.size());
  return std::abs((y.transpose() * stiffness_ * x).value()) <= round_off * sum_of_terms(stiffness_, y, x) &&
         (stiffness_ * x).norm() <= round_off * (stiffness_.cwiseAbs() * x.cwiseAbs()).norm();
}

RefinedEigenvalue EigenvalueRefinement::refine(std::complex<double> start) const {
  const Eigen::Index n = mass_.rows();
  const double round_off = 4 * unit_roundoff * static_cast<double>(n);
  std::complex<double> mu = start == 0.0 ? round_off : start / rate_;  // P(0) may have no inverse
  ComplexVector x = ComplexVector::Ones(n), y = x;
  for (int i = 0; i < most_iterations; ++i) {
    const std::complex<double> shift = beside_it * mu;
    const Eigen::MatrixXcd p = shift * shift * mass_ + shift * damping_ + stiffness_;
    const Eigen::MatrixXcd slope = 2.0 * mu * mass_ + damping_;
    const Eigen::PartialPivLU<Eigen::MatrixXcd> factor(p);
    for (int again = 0; again < (i == 0 ? 3 : 1); ++again) {
      x = factor.solve(mass_ * x).eval().normalized();
      y = symmetric_ ? x : factor.transpose().solve(mass_ * y).eval().normalized();
    }
    if (!x.allFinite() || !y.allFinite()) break;
    if (is_rigid(x, y)) return {0, true};
    const std::complex<double> by = (y.transpose() * slope * x).value();
    const std::complex<double> change =
        -(y.transpose() * residual(mass_, damping_, stiffness_, mu, x)).value() / by;
    mu += change;
    double terms = std::abs(mu) * sum_of_terms(damping_, y, x);
    if (!symmetric_) terms += std::norm(mu) * sum_of_terms(mass_, y, x) + sum_of_terms(stiffness_, y, x);
    const double unknown = round_off * terms / std::abs(by);
    if (std::abs(change) > settled * std::abs(mu)) continue;
    if (std::abs(mu.real()) <= unknown) return {{0, start.imag()}};
    if (std::abs(change.real()) <= settled * std::abs(mu.real())) return {rate_ * mu};
  }
  // One of a cluster that did not settle, as of motions that nothing resists.
  return {{0, std::abs(start)}, std::abs(start) <= 1e-6 * rate_};
}

}  // namespace springstab
