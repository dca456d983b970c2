// Polynomials in one variable, and rational functions of X = hd and Y = h²k.
//
// A method's step uses only +, -, *, / on its vectors. Run it on RationalFunction instead of numbers and what
// comes out is the method's amplification matrix as a formula: the analysis never writes one down itself.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace springstab {

/// c[0] + c[1] t + c[2] t² + ...; no coefficients is the zero polynomial.
struct Polynomial {
  std::vector<double> c;

  double operator()(double t) const;
  bool is_zero() const { return c.empty(); }
  Polynomial derivative() const;
  /// Real roots, ascending; a root of even multiplicity may appear as a close pair or a near-real one and is
  /// then given by its real part. Empty for a constant. Throws std::runtime_error if GSL's solver fails.
  std::vector<double> real_roots() const;
};

Polynomial operator+(const Polynomial& p, const Polynomial& q);
Polynomial operator-(Polynomial p);
Polynomial operator*(const Polynomial& p, const Polynomial& q);

/// Σ c_ab X^a Y^b. Beside each coefficient stands the sum of the magnitudes that went into it, so that what
/// is only rounding noise of a cancellation can be told from a small coefficient and removed.
class BivariatePolynomial {
 public:
  BivariatePolynomial(double constant = 0);
  static BivariatePolynomial x();
  static BivariatePolynomial y();

  double operator()(double x, double y) const;
  BivariatePolynomial derivative_x() const;
  /// p(X(t), Y(t)), noise removed.
  Polynomial along(const Polynomial& x, const Polynomial& y) const;
  /// c, a, b where the polynomial is c + a X + b Y.
  std::optional<std::array<double, 3>> affine() const;
  /// The same with coefficients below 1e-14 of their magnitude sums set to 0.
  BivariatePolynomial without_noise() const;

  friend BivariatePolynomial operator+(const BivariatePolynomial& p, const BivariatePolynomial& q);
  friend BivariatePolynomial operator-(const BivariatePolynomial& p);
  friend BivariatePolynomial operator*(const BivariatePolynomial& p, const BivariatePolynomial& q);
  friend bool operator==(const BivariatePolynomial& p, const BivariatePolynomial& q);
  /// p / q where q divides p but for rounding noise, otherwise nothing.
  friend std::optional<BivariatePolynomial> exact_quotient(BivariatePolynomial p,
                                                           const BivariatePolynomial& q);

 private:
  BivariatePolynomial(Eigen::ArrayXXd value, Eigen::ArrayXXd magnitude);
  /// Exponents of the leading monomial: highest power of X, then of Y; (-1, -1) for zero.
  std::pair<Eigen::Index, Eigen::Index> leading() const;

  Eigen::ArrayXXd value_, magnitude_;  // (a, b) is the coefficient of X^a Y^b
};

/// numerator / (q₁ q₂ ...), reduced: no factor q divides the numerator. Denominators stay factored because a
/// method divides by few and simple ones (1 + X + Y for implicit Euler), again and again.
class RationalFunction {
 public:
  RationalFunction(double constant = 0) : numerator_(constant) {}
  RationalFunction(BivariatePolynomial p) : numerator_(std::move(p)) {}

  double operator()(double x, double y) const { return numerator_(x, y) / denominator()(x, y); }
  const BivariatePolynomial& numerator() const { return numerator_; }
  BivariatePolynomial denominator() const;
  /// c, a, b where the function is c + a X + b Y.
  std::optional<std::array<double, 3>> affine() const {
    return factors_.empty() ? numerator_.affine() : std::nullopt;
  }

  friend RationalFunction operator+(const RationalFunction& f, const RationalFunction& g);
  friend RationalFunction operator-(const RationalFunction& f);
  friend RationalFunction operator*(const RationalFunction& f, const RationalFunction& g);
  friend RationalFunction operator/(const RationalFunction& f, const RationalFunction& g);

 private:
  RationalFunction(const BivariatePolynomial& p, std::vector<BivariatePolynomial> factors);

  BivariatePolynomial numerator_;
  std::vector<BivariatePolynomial> factors_;
};

inline RationalFunction operator-(const RationalFunction& f, const RationalFunction& g) { return f + -g; }

inline bool all_finite(const RationalFunction&) { return true; }

}  // namespace springstab
