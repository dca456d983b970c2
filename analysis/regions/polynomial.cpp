#include "analysis/regions/polynomial.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "analysis/gsl/numerics.h"

namespace springstab {

namespace {

constexpr double noise = 1e-14;  // some tens of roundings

void trim(std::vector<double>& c) {
  while (!c.empty() && c.back() == 0) c.pop_back();
}

// Newton's method at a simple root gains the digits that the companion matrix lost.
double polished(const Polynomial& p, const Polynomial& slope, double root) {
  for (int i = 0; i < 10; ++i) {
    const double better = root - p(root) / slope(root);
    if (!std::isfinite(better) || !(std::abs(p(better)) < std::abs(p(root)))) break;
    root = better;
  }
  return root;
}

// Horner's scheme for polynomials, in place: it is most of what the constants of a region cost.
class Horner {
 public:
  /// p <- p q + r
  void step(std::span<const double> q, std::span<const double> r) {
    next_.assign(std::max(p_.empty() || q.empty() ? 0 : p_.size() + q.size() - 1, r.size()), 0.0);
    for (std::size_t i = 0; i < p_.size(); ++i)
      for (std::size_t j = 0; j < q.size(); ++j) next_[i + j] += p_[i] * q[j];
    for (std::size_t i = 0; i < r.size(); ++i) next_[i] += r[i];
    trim(next_);
    p_.swap(next_);
  }
  void clear() { p_.clear(); }
  std::span<const double> value() const { return p_; }

 private:
  std::vector<double> p_, next_;
};

// Σ c_ab X^a Y^b
Polynomial substituted(const Eigen::ArrayXXd& c, const Polynomial& x, const Polynomial& y) {
  Horner sum, row;
  for (Eigen::Index a = c.rows(); a-- > 0;) {
    row.clear();
    for (Eigen::Index b = c.cols(); b-- > 0;) row.step(y.c, {&c(a, b), 1});
    sum.step(x.c, row.value());
  }
  return {{sum.value().begin(), sum.value().end()}};
}

}  // namespace

double Polynomial::operator()(double t) const {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * t + c[i];
  return sum;
}

Polynomial Polynomial::derivative() const {
  Polynomial d;
  for (std::size_t i = 1; i < c.size(); ++i) d.c.push_back(static_cast<double>(i) * c[i]);
  return d;
}

Polynomial operator+(const Polynomial& p, const Polynomial& q) {
  Polynomial sum{p.c};
  sum.c.resize(std::max(p.c.size(), q.c.size()), 0.0);
  for (std::size_t i = 0; i < q.c.size(); ++i) sum.c[i] += q.c[i];
  trim(sum.c);
  return sum;
}

Polynomial operator-(Polynomial p) {
  for (double& v : p.c) v = -v;
  return p;
}

Polynomial operator*(const Polynomial& p, const Polynomial& q) {
  Polynomial product;
  if (p.is_zero() || q.is_zero()) return product;
  product.c.resize(p.c.size() + q.c.size() - 1, 0.0);
  for (std::size_t i = 0; i < p.c.size(); ++i)
    for (std::size_t j = 0; j < q.c.size(); ++j) product.c[i + j] += p.c[i] * q.c[j];
  return product;
}

std::vector<double> Polynomial::real_roots() const {
  std::vector<double> roots;
  std::vector<double> a = c;
  trim(a);
  const auto zeros = std::find_if(a.begin(), a.end(), [](double v) { return v != 0; }) - a.begin();
  a.erase(a.begin(), a.begin() + zeros);
  if (zeros > 0) roots.push_back(0.0);
  if (a.size() > 1) {
    const Polynomial p{a}, slope = p.derivative();
    for (const std::complex<double>& z : polynomial_roots(a))
      if (std::abs(z.imag()) <= 1e-6 * std::abs(z.real())) roots.push_back(polished(p, slope, z.real()));
  }
  std::sort(roots.begin(), roots.end());
  return roots;
}

BivariatePolynomial::BivariatePolynomial(double constant)
    : value_(Eigen::ArrayXXd::Constant(1, 1, constant)), magnitude_(value_.abs()) {}

BivariatePolynomial::BivariatePolynomial(Eigen::ArrayXXd value, Eigen::ArrayXXd magnitude)
    : value_(std::move(value)), magnitude_(std::move(magnitude)) {}

BivariatePolynomial BivariatePolynomial::x() {
  Eigen::ArrayXXd c(2, 1);
  c << 0, 1;
  return {c, c};
}

BivariatePolynomial BivariatePolynomial::y() {
  Eigen::ArrayXXd c(1, 2);
  c << 0, 1;
  return {c, c};
}

double BivariatePolynomial::operator()(double x, double y) const {
  double sum = 0;
  for (Eigen::Index a = value_.rows(); a-- > 0;) {
    double row = 0;
    for (Eigen::Index b = value_.cols(); b-- > 0;) row = row * y + value_(a, b);
    sum = sum * x + row;
  }
  return sum;
}

BivariatePolynomial BivariatePolynomial::derivative_x() const {
  if (value_.rows() == 1) return 0.0;
  const Eigen::Index n = value_.rows() - 1;
  const Eigen::ArrayXd factor = Eigen::ArrayXd::LinSpaced(n, 1, static_cast<double>(n));
  return {value_.bottomRows(n).colwise() * factor, magnitude_.bottomRows(n).colwise() * factor};
}

Polynomial BivariatePolynomial::along(const Polynomial& x, const Polynomial& y) const {
  const auto absolute = [](Polynomial p) {
    for (double& c : p.c) c = std::abs(c);
    return p;
  };
  Polynomial sum = substituted(value_, x, y);
  const Polynomial size = substituted(value_.abs(), absolute(x), absolute(y));
  for (std::size_t i = 0; i < sum.c.size(); ++i)
    if (std::abs(sum.c[i]) <= noise * size.c[i]) sum.c[i] = 0;
  trim(sum.c);
  return sum;
}

std::optional<std::array<double, 3>> BivariatePolynomial::affine() const {
  std::array<double, 3> found{};
  const Eigen::ArrayXXd value = without_noise().value_;
  for (Eigen::Index a = 0; a < value.rows(); ++a)
    for (Eigen::Index b = 0; b < value.cols(); ++b) {
      if (value(a, b) == 0) continue;
      if (a + b > 1) return std::nullopt;
      found[static_cast<std::size_t>(a + 2 * b)] = value(a, b);
    }
  return found;
}

BivariatePolynomial BivariatePolynomial::without_noise() const {
  return {(value_.abs() <= noise * magnitude_).select(0.0, value_), magnitude_};
}

BivariatePolynomial operator+(const BivariatePolynomial& p, const BivariatePolynomial& q) {
  const Eigen::Index rows = std::max(p.value_.rows(), q.value_.rows());
  const Eigen::Index cols = std::max(p.value_.cols(), q.value_.cols());
  BivariatePolynomial sum(Eigen::ArrayXXd::Zero(rows, cols), Eigen::ArrayXXd::Zero(rows, cols));
  for (const BivariatePolynomial* term : {&p, &q}) {
    sum.value_.topLeftCorner(term->value_.rows(), term->value_.cols()) += term->value_;
    sum.magnitude_.topLeftCorner(term->value_.rows(), term->value_.cols()) += term->magnitude_;
  }
  return sum;
}

BivariatePolynomial operator-(const BivariatePolynomial& p) { return {-p.value_, p.magnitude_}; }

BivariatePolynomial operator*(const BivariatePolynomial& p, const BivariatePolynomial& q) {
  const Eigen::Index rows = p.value_.rows() + q.value_.rows() - 1;
  const Eigen::Index cols = p.value_.cols() + q.value_.cols() - 1;
  BivariatePolynomial product(Eigen::ArrayXXd::Zero(rows, cols), Eigen::ArrayXXd::Zero(rows, cols));
  for (Eigen::Index a = 0; a < p.value_.rows(); ++a)
    for (Eigen::Index b = 0; b < p.value_.cols(); ++b) {
      product.value_.block(a, b, q.value_.rows(), q.value_.cols()) += p.value_(a, b) * q.value_;
      product.magnitude_.block(a, b, q.value_.rows(), q.value_.cols()) += p.magnitude_(a, b) * q.magnitude_;
    }
  return product;
}

bool operator==(const BivariatePolynomial& p, const BivariatePolynomial& q) {
  return (p + -q).leading().first < 0;
}

std::pair<Eigen::Index, Eigen::Index> BivariatePolynomial::leading() const {
  for (Eigen::Index a = value_.rows(); a-- > 0;)
    for (Eigen::Index b = value_.cols(); b-- > 0;)
      if (value_(a, b) != 0) return {a, b};
  return {-1, -1};
}

std::optional<BivariatePolynomial> exact_quotient(BivariatePolynomial p, const BivariatePolynomial& q) {
  const auto [qa, qb] = q.leading();
  BivariatePolynomial quotient(Eigen::ArrayXXd::Zero(p.value_.rows(), p.value_.cols()),
                               Eigen::ArrayXXd::Zero(p.value_.rows(), p.value_.cols()));
  p = p.without_noise();
  while (true) {  // each round removes the leading monomial of what is left
    const auto [pa, pb] = p.leading();
    if (pa < 0) return quotient;
    if (pa < qa || pb < qb) return std::nullopt;
    const double factor = p.value_(pa, pb) / q.value_(qa, qb);
    quotient.value_(pa - qa, pb - qb) = factor;
    quotient.magnitude_(pa - qa, pb - qb) = std::abs(factor);
    for (Eigen::Index a = 0; a <= qa; ++a)
      for (Eigen::Index b = 0; b < q.value_.cols(); ++b) {
        if (q.value_(a, b) == 0) continue;
        const Eigen::Index row = pa - qa + a, col = pb - qb + b;
        if (col >= p.value_.cols()) return std::nullopt;
        p.value_(row, col) -= factor * q.value_(a, b);
        p.magnitude_(row, col) += std::abs(factor * q.value_(a, b));
      }
    p.value_(pa, pb) = 0;
    p = p.without_noise();
  }
}

RationalFunction::RationalFunction(const BivariatePolynomial& p, std::vector<BivariatePolynomial> factors)
    : numerator_(p.without_noise()) {
  for (BivariatePolynomial& q : factors) {
    if (auto quotient = exact_quotient(numerator_, q)) {
      numerator_ = *std::move(quotient);
    } else {
      factors_.push_back(std::move(q));
    }
  }
}

BivariatePolynomial RationalFunction::denominator() const {
  BivariatePolynomial product = 1.0;
  for (const BivariatePolynomial& q : factors_) product = product * q;
  return product;
}

RationalFunction operator+(const RationalFunction& f, const RationalFunction& g) {
  // Over the least common denominator: what only g has multiplies f, and the other way round.
  std::vector<BivariatePolynomial> common = f.factors_, only_f = f.factors_;
  BivariatePolynomial p = f.numerator_, q = g.numerator_;
  for (const BivariatePolynomial& factor : g.factors_) {
    if (const auto shared = std::find(only_f.begin(), only_f.end(), factor); shared != only_f.end()) {
      only_f.erase(shared);
    } else {
      common.push_back(factor);
      p = p * factor;
    }
  }
  for (const BivariatePolynomial& factor : only_f) q = q * factor;
  return {p + q, std::move(common)};
}

RationalFunction operator-(const RationalFunction& f) { return {-f.numerator_, f.factors_}; }

RationalFunction operator*(const RationalFunction& f, const RationalFunction& g) {
  std::vector<BivariatePolynomial> factors = f.factors_;
  factors.insert(factors.end(), g.factors_.begin(), g.factors_.end());
  return {f.numerator_ * g.numerator_, std::move(factors)};
}

RationalFunction operator/(const RationalFunction& f, const RationalFunction& g) {
  std::vector<BivariatePolynomial> factors = f.factors_;
  factors.push_back(g.numerator_);
  return {f.numerator_ * g.denominator(), std::move(factors)};
}

}  // namespace springstab
