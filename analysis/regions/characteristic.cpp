#include "analysis/regions/characteristic.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

using Functions = std::vector<RationalFunction>;

// By expansion along rows: the minors of the first rows, over every set of columns.
template <class T, class Entry>
T determinant(std::size_t n, const T& zero, const T& one, const Entry& entry) {
  std::vector<T> minor(std::size_t{1} << n, zero);
  minor[0] = one;
  for (std::size_t columns = 1; columns < minor.size(); ++columns) {
    const auto row = static_cast<std::size_t>(std::popcount(columns)) - 1;
    for (std::size_t j = 0; j < n; ++j) {
      if (!(columns >> j & 1)) continue;
      const T term = entry(row, j) * minor[columns & ~(std::size_t{1} << j)];
      minor[columns] = minor[columns] + (std::popcount(columns >> j) % 2 == 1 ? term : -term);
    }
  }
  return minor.back();
}

// det(λ - A), coefficients of λ^0 ... λ^m, by Faddeev and LeVerrier.
Functions characteristic_of(const Functions& a) {
  const auto m = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a.size()))));
  if (m == 2) return {a[0] * a[3] - a[1] * a[2], -(a[0] + a[3]), 1.0};
  Functions c(m + 1, 0.0), power(m * m, 0.0);
  c[m] = 1.0;
  for (std::size_t k = 1; k <= m; ++k) {
    Functions next(m * m, 0.0);
    for (std::size_t i = 0; i < m; ++i) power[i * m + i] = power[i * m + i] + c[m - k + 1];
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j)
        for (std::size_t l = 0; l < m; ++l)
          next[i * m + j] = next[i * m + j] + a[i * m + l] * power[l * m + j];
    for (std::size_t i = 0; i < m; ++i) c[m - k] = c[m - k] - next[i * m + i];
    c[m - k] = c[m - k] * (1.0 / static_cast<double>(k));
    power = std::move(next);
  }
  return c;
}

bool is_zero(const RationalFunction& f) { return f.numerator() == BivariatePolynomial(0.0); }

RationalFunction at(const Functions& c, double lambda) {
  RationalFunction sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * lambda + c[i];
  return sum;
}

// c / (λ - root), which divides it.
Functions divided(const Functions& c, double root) {
  Functions quotient(c.size() - 1, 0.0);
  RationalFunction carry = 0.0;
  for (std::size_t i = c.size() - 1; i > 0; --i) quotient[i - 1] = carry = c[i] + carry * root;
  return quotient;
}

Functions without_constant_eigenvalues(Functions c) {
  for (const double root : {0.0, -1.0, 1.0})
    while (c.size() > 3 && is_zero(at(c, root))) c = divided(c, root);
  return c;
}

// Π_{i<j} (1 - λ_i λ_j), Jury's inner determinant of the coefficients: of order n - 1.
RationalFunction pair_condition(const Functions& c) {
  const std::size_t n = c.size() - 1;
  return determinant<RationalFunction>(n - 1, 0.0, 1.0, [&](std::size_t i, std::size_t j) {
    RationalFunction entry = 0.0;
    if (j >= i) entry = entry + c[n - (j - i)];
    if (i + j + 2 >= n) entry = entry - c[i + j + 2 - n];
    return entry;
  });
}

std::array<RationalFunction, 3> conditions_of(const Functions& c) {
  const RationalFunction one = 1.0;
  if (c.size() == 3) {
    const RationalFunction trace = -c[1], &determinant_of = c[0];
    return {one - determinant_of, one - trace + determinant_of, one + trace + determinant_of};
  }
  const RationalFunction odd = at(c, -1.0);
  return {pair_condition(c), at(c, 1.0), c.size() % 2 == 1 ? odd : -odd};
}

// The coefficients along a curve over their common denominator.
std::vector<Polynomial> along(const Functions& c, const Curve& curve) {
  std::vector<Polynomial> numerators, denominators, common;
  for (const RationalFunction& f : c) {
    numerators.push_back(f.numerator().along(curve.x, curve.y));
    denominators.push_back(f.denominator().along(curve.x, curve.y));
  }
  const auto same = [](const Polynomial& p) { return [&p](const Polynomial& q) { return p.c == q.c; }; };
  for (const Polynomial& q : denominators)
    if (std::none_of(common.begin(), common.end(), same(q))) common.push_back(q);
  for (std::size_t i = 0; i < c.size(); ++i)
    for (const Polynomial& q : common)
      if (q.c != denominators[i].c) numerators[i] = numerators[i] * q;
  return numerators;
}

bool is_palindrome(const std::vector<Polynomial>& p) {
  for (std::size_t i = 0; i < p.size() / 2; ++i) {
    const std::vector<double>&a = p[i].c, &b = p[p.size() - 1 - i].c;
    if (a.size() != b.size()) return false;
    for (std::size_t j = 0; j < a.size(); ++j)
      if (std::abs(a[j] - b[j]) > 1e-12 * (std::abs(a[j]) + std::abs(b[j]))) return false;
  }
  return p.size() % 2 == 1;
}

// p(λ)/λ^r as a polynomial in w = λ + 1/λ, since λ^k + λ^-k = V_k(w), V_{k+1} = w V_k - V_{k-1}.
std::vector<Polynomial> in_reciprocal_sums(const std::vector<Polynomial>& p) {
  const std::size_t r = (p.size() - 1) / 2;
  std::vector<Polynomial> q(r + 1);
  std::vector<double> before{2}, v{0, 1};
  q[0] = p[r];
  for (std::size_t k = 1; k <= r; ++k) {
    for (std::size_t i = 0; i < v.size(); ++i) q[i] = q[i] + Polynomial{{v[i]}} * p[r + k];
    std::vector<double> next(v.size() + 1, 0.0);
    for (std::size_t i = 0; i < v.size(); ++i) next[i + 1] = v[i];
    for (std::size_t i = 0; i < before.size(); ++i) next[i] -= before[i];
    before = std::exchange(v, std::move(next));
  }
  return q;
}

}  // namespace

CharacteristicPolynomial::CharacteristicPolynomial(const std::vector<RationalFunction>& matrix)
    : coefficients_(without_constant_eigenvalues(characteristic_of(matrix))),
      conditions_(conditions_of(coefficients_)) {}

Eigen::VectorXd CharacteristicPolynomial::moduli(double x, double y) const {
  const auto n = static_cast<Eigen::Index>(degree());
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index i = 0; i < n; ++i)
    companion(i, n - 1) = -coefficients_[static_cast<std::size_t>(i)](x, y);
  if (!companion.allFinite()) return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  return companion.eigenvalues().cwiseAbs();
}

// The resultant of p and its derivative, by Sylvester's matrix.
Polynomial CharacteristicPolynomial::discriminant(const Curve& curve) const {
  std::vector<Polynomial> p = along(coefficients_, curve);
  if (is_palindrome(p)) p = in_reciprocal_sums(p);
  const std::size_t n = p.size() - 1;
  std::vector<Polynomial> slope;
  for (std::size_t i = 1; i <= n; ++i) slope.push_back(Polynomial{{static_cast<double>(i)}} * p[i]);
  return determinant<Polynomial>(2 * n - 1, {}, {{1.0}}, [&](std::size_t i, std::size_t j) -> Polynomial {
    const std::vector<Polynomial>& row = i < n - 1 ? p : slope;
    const std::size_t shift = i < n - 1 ? i : i - (n - 1);
    return j >= shift && j - shift < row.size() ? row[row.size() - 1 - (j - shift)] : Polynomial{};
  });
}

}  // namespace springstab
