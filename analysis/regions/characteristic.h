// The characteristic polynomial of a method's matrix A(X, Y), and the conditions under which the number of
// eigenvalues outside the unit disk can change.
//
// Along any curve that number changes only at a pole or where one of three functions vanishes (Λ²A: the
// second exterior power, whose eigenvalues are the products λ_i λ_j, i < j):
//     Π_{i<j} (1 - λ_i λ_j) = det(I - Λ²A)   (a complex pair on the unit circle, or real λ_i λ_j = 1),
//     det(I - A)                             (λ = 1),
//     det(I + A)                             (λ = -1).
// For 2x2 matrices they are Jury's three (Jury 1964), 1 - Δ, 1 - T + Δ and 1 + T + Δ, and all positive means
// stable; for larger ones their signs do not decide, and the eigenvalues between two roots do.
// Includes polynomial.h alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "analysis/regions/polynomial.h"

namespace springstab {

/// A plane curve t -> (x(t), y(t)).
struct Curve {
  Polynomial x, y;
};

class CharacteristicPolynomial {
 public:
  /// Of an m x m matrix, m >= 2, row by row. Eigenvalues that are 0, 1 or -1 for all X and Y are divided out,
  /// as long as more than two are left: they are carried along and never end stability.
  explicit CharacteristicPolynomial(const std::vector<RationalFunction>& matrix);

  /// What is left of m.
  std::size_t degree() const { return coefficients_.size() - 1; }
  /// Of λ^i, i = 0 ... degree; the last is 1.
  const std::vector<RationalFunction>& coefficients() const { return coefficients_; }
  /// In the order of `enum class Bound`.
  const std::array<RationalFunction, 3>& conditions() const { return conditions_; }

  /// |λ| of those left; all ∞ at a pole.
  Eigen::VectorXd moduli(double x, double y) const;
  double radius(double x, double y) const { return moduli(x, y).maxCoeff(); }

  /// Along a curve on which the first condition vanishes identically, as on X = 0 for symmetric multistep
  /// methods, whose roots come in reciprocal pairs: zero where two of the roots meet. Of a palindromic
  /// polynomial those in λ + 1/λ are meant, since its roots meet in pairs.
  Polynomial discriminant(const Curve& curve) const;

 private:
  std::vector<RationalFunction> coefficients_;
  std::array<RationalFunction, 3> conditions_;
};

}  // namespace springstab
