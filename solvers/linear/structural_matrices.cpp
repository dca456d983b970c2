#include "solvers/linear/structural_matrices.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace springstab {
namespace {

using Triplet = Eigen::Triplet<double>;

constexpr double symmetry_tolerance = 1e-10;  // real matrices are symmetric to rounding
constexpr Eigen::Index largest_condensed = 5000;

std::string shape(const SparseMatrix& a) {
  return std::to_string(a.rows()) + " x " + std::to_string(a.cols());
}

// The first entry that differs from its mirror image by more than rounding: of the larger one, and of what a
// definite matrix could have there, √(a_ii a_jj). So it counts what is small beside others.
std::optional<Triplet> asymmetric_entry(const SparseMatrix& a, const SparseMatrix& transposed) {
  const SparseMatrix difference = a - transposed;
  const Eigen::VectorXd root = Eigen::VectorXd(a.diagonal()).cwiseAbs().cwiseSqrt();
  for (Eigen::Index j = 0; j < difference.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(difference, j); it; ++it) {
      const double larger = std::max(std::abs(a.coeff(it.row(), j)), std::abs(a.coeff(j, it.row())));
      if (std::abs(it.value()) > symmetry_tolerance * std::max(larger, root[it.row()] * root[j]))
        return Triplet(static_cast<int>(it.row()), static_cast<int>(j), it.value());
    }
  return std::nullopt;
}

// The symmetric part of `a`, after checking that there is next to nothing else; or all of it, where
// `symmetric` is given to be cleared if there is.
SparseMatrix checked(SparseMatrix a, const std::string& name, Eigen::Index size, bool* symmetric = nullptr) {
  a.makeCompressed();
  if (a.rows() != a.cols() || a.rows() != size)
    throw std::invalid_argument("the " + name + " matrix is " + shape(a) + ", expected " +
                                std::to_string(size) + " x " + std::to_string(size));
  for (Eigen::Index k = 0; k < a.nonZeros(); ++k)
    if (!std::isfinite(a.valuePtr()[k]))
      throw std::invalid_argument("the " + name +
                                  " matrix has an entry that is not finite, expected finite numbers");
  const SparseMatrix transposed = a.transpose();
  if (const std::optional<Triplet> entry = asymmetric_entry(a, transposed)) {
    if (symmetric) {
      *symmetric = false;
      return a;
    }
    std::ostringstream message;
    message << "the " << name << " matrix is not symmetric (entry " << entry->row() + 1 << ", "
            << entry->col() + 1 << " differs from its mirror image by " << std::abs(entry->value())
            << "), expected a symmetric one";
    throw std::invalid_argument(message.str());
  }
  return a + 0.5 * (transposed - a);  // neither overflows nor underflows where both are the same
}

// Rows and columns `keep` of a, in that order; -1 in `position` marks what is dropped.
SparseMatrix extract(const SparseMatrix& a, const std::vector<Eigen::Index>& row_position,
                     const std::vector<Eigen::Index>& col_position, Eigen::Index rows, Eigen::Index cols) {
  std::vector<Triplet> triplets;
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (row_position[it.row()] >= 0 && col_position[it.col()] >= 0)
        triplets.emplace_back(static_cast<int>(row_position[it.row()]),
                              static_cast<int>(col_position[it.col()]), it.value());
  SparseMatrix part(rows, cols);
  part.setFromTriplets(triplets.begin(), triplets.end());
  return part;
}

// Whether `a` is positive definite beyond doubt: a singular matrix often passes a Cholesky factorization by
// its rounding alone, which is at most Σ γ(l_i + 2) a_ii with l_i the entries of row i of the factor (Rump
// 2006).
bool is_definite(const SparseMatrix& a) {
  const Eigen::VectorXd diagonal = a.diagonal();
  if (!(diagonal.array() > 0).all()) return false;
  const Eigen::VectorXd d = diagonal.cwiseSqrt().cwiseInverse();
  const SparseMatrix unit = scaled(a, d);
  Eigen::SimplicialLLT<SparseMatrix> factor(unit);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::Index entries = SparseMatrix(factor.matrixL()).nonZeros() + 2 * a.rows();
  SparseMatrix shift(a.rows(), a.cols());
  shift.setIdentity();
  shift *= std::numeric_limits<double>::epsilon() * static_cast<double>(entries);
  factor.factorize(unit - shift);
  return factor.info() == Eigen::Success;
}

// The alpha of D's rows of massless unknowns, which must be alpha >= 0 times K's to 1e-10 of the row: then
// what the unknowns are away from where K alone would hold them decays like exp(-t/alpha) and never comes
// back.
double massless_alpha(const StructuralMatrices& s, const std::vector<Eigen::Index>& massless) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(s.size());
  const Eigen::VectorXd damped = s.damping.cwiseAbs() * ones, stiff = s.stiffness.cwiseAbs() * ones;
  double alpha = 0;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (massless[i] >= 0 && stiff[i] > 0) alpha = std::max(alpha, damped[i] / stiff[i]);
  const Eigen::VectorXd rest = SparseMatrix(s.damping - alpha * s.stiffness).cwiseAbs() * ones;
  Eigen::Index wrong = -1;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (massless[i] >= 0 && rest[i] > 1e-10 * damped[i] && (wrong < 0 || damped[wrong] == 0)) wrong = i;
  if (wrong >= 0)
    throw std::invalid_argument("unknown " + std::to_string(wrong + 1) + " has " +
                                (damped[wrong] > 0 ? "damping" : "stiffness without damping") +
                                " but no mass, expected D = alpha K in the rows of all massless unknowns");
  return alpha;
}

void condense(StructuralMatrices& s) {
  const Eigen::Index n = s.size();
  std::vector<Eigen::Index> heavy(n, -1), massless(n, -1);
  Eigen::Index a = 0, b = 0;
  const Eigen::VectorXd row_size = s.mass.cwiseAbs() * Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) (row_size[i] > 0 ? heavy[i] = a++ : massless[i] = b++);
  if (b == 0) return;
  if (s.says_implicit())
    throw std::invalid_argument(std::to_string(b) +
                                " unknowns have no mass, expected mass for all beside an implicit damping "
                                "matrix");
  if (a == 0) throw std::invalid_argument("the mass matrix is zero, expected some mass");
  if (a > largest_condensed)
    throw std::invalid_argument("eliminating " + std::to_string(b) +
                                " massless unknowns would fill a matrix of " + std::to_string(a) +
                                " unknowns, expected at most " + std::to_string(largest_condensed));
  const double alpha = s.has_damping() ? massless_alpha(s, massless) : 0;

  const SparseMatrix k_ab = extract(s.stiffness, heavy, massless, a, b);
  const SparseMatrix k_bb = extract(s.stiffness, massless, massless, b, b);
  if (!is_definite(k_bb))
    throw std::invalid_argument("the stiffness between the " + std::to_string(b) +
                                " massless unknowns is not positive definite, expected that they are held");
  const Eigen::SimplicialLLT<SparseMatrix> factor(k_bb);
  const Eigen::MatrixXd correction = k_ab * factor.solve(Eigen::MatrixXd(k_ab.transpose()));
  const SparseMatrix removed = (0.5 * (correction + correction.transpose())).sparseView(0.0, 0.0);
  s.stiffness = extract(s.stiffness, heavy, heavy, a, a) - removed;
  s.mass = extract(s.mass, heavy, heavy, a, a);
  if (s.has_damping()) s.damping = extract(s.damping, heavy, heavy, a, a) - alpha * removed;
  s.condensed = b;
  if (alpha > 0) s.condensed_rate = 1 / alpha;
}

// Of K and D only symmetric ones are accepted, unless they may be `any`.
StructuralMatrices prepare(const SparseMatrix& stiffness, const SparseMatrix& mass,
                           const SparseMatrix& damping, const RayleighDamping& more,
                           const SparseMatrix& implicit, bool any) {
  const Eigen::Index n = stiffness.rows();
  if (n == 0) throw std::invalid_argument("the stiffness matrix is empty, expected at least one unknown");
  StructuralMatrices s;
  s.stiffness = checked(stiffness, "stiffness", n, any ? &s.symmetric : nullptr);
  if (mass.size() > 0) {
    s.mass = checked(mass, "mass", n);
  } else {
    s.mass.resize(n, n);
    s.mass.setIdentity();
  }
  if (damping.size() > 0) s.damping = checked(damping, "damping", n, any ? &s.symmetric : nullptr);
  if (more.d0 != 0 || more.alpha != 0) {
    const SparseMatrix added = more.d0 * s.mass + more.alpha * s.stiffness;
    s.damping = s.damping.size() > 0 ? SparseMatrix(s.damping + added) : added;
  }
  if (implicit.size() > 0) {
    s.implicit_damping = checked(implicit, "implicit damping", n, any ? &s.symmetric : nullptr);
    s.damping = s.damping.size() > 0 ? SparseMatrix(s.damping + s.implicit_damping) : s.implicit_damping;
  }
  for (Eigen::Index i = 0; i < n; ++i)
    if (s.mass.coeff(i, i) < 0) {
      std::ostringstream message;
      message << "the mass of unknown " << i + 1 << " is " << s.mass.coeff(i, i)
              << ", expected no negative mass";
      throw std::invalid_argument(message.str());
    }
  if (s.symmetric) condense(s);
  if (!is_definite(s.mass))
    throw std::invalid_argument("the mass matrix is not positive definite, expected a positive definite one");
  return s;
}

}  // namespace

SparseMatrix lumped_mass(std::span<const double> mass) {
  Eigen::VectorXd diagonal(3 * static_cast<Eigen::Index>(mass.size()));
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) diagonal[i] = mass[i / 3];
  return SparseMatrix(diagonal.asDiagonal());
}

void scale(SparseMatrix& a, const Eigen::VectorXd& d) {
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it) it.valueRef() = d[it.row()] * it.value() * d[j];
}

SparseMatrix scaled(const SparseMatrix& a, const Eigen::VectorXd& d) {
  SparseMatrix b = a;
  scale(b, d);
  return b;
}

int most_in_a_column(const SparseMatrix& a) {
  int most = 0;
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    most = std::max(most, a.outerIndexPtr()[j + 1] - a.outerIndexPtr()[j]);
  return most;
}

bool is_diagonal(const SparseMatrix& a) {
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (it.row() != it.col() && it.value() != 0) return false;
  return true;
}

SparseMatrix implicit_damping(const StructuralMatrices& s, DampingPart part) {
  const SparseMatrix& offered = s.says_implicit() ? s.implicit_damping : s.damping;
  if (offered.size() == 0) return {s.size(), s.size()};
  if (part == DampingPart::all) return offered;
  return SparseMatrix(Eigen::VectorXd(offered.diagonal()).asDiagonal());
}

StructuralMatrices prepare(const SparseMatrix& stiffness, const SparseMatrix& mass,
                           const SparseMatrix& damping, const RayleighDamping& more,
                           const SparseMatrix& implicit_damping) {
  return prepare(stiffness, mass, damping, more, implicit_damping, false);
}

StructuralMatrices prepare_nonsymmetric(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                        const SparseMatrix& damping, const RayleighDamping& more,
                                        const SparseMatrix& implicit_damping) {
  return prepare(stiffness, mass, damping, more, implicit_damping, true);
}

}  // namespace springstab
