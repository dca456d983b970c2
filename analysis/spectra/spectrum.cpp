#include "analysis/spectra/spectrum.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "analysis/constants.h"
#include "analysis/proofs/definiteness.h"
#include "analysis/spectra/chebyshev_filter.h"
#include "analysis/spectra/lanczos.h"
#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/team.h"

namespace springstab {
namespace {

using Cholesky = Eigen::SimplicialLLT<SparseMatrix>;

constexpr Eigen::Index nonsymmetric_limit = 400;

// Of a residual beside the value: what is more is rounding or a search that went astray, no eigenvalue.
constexpr double least_accuracy = 1e-6;

// 1/√M_ii: makes the pencil dimensionless per unknown, whatever the ratio of the masses.
Eigen::VectorXd inverse_root(const SparseMatrix& mass) { return mass.diagonal().cwiseSqrt().cwiseInverse(); }

// Absolute row sums of diag(d) A diag(d).
Eigen::VectorXd scaled_row_sums(const SparseMatrix& a, const Eigen::VectorXd& d) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(a.rows());
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      sums[it.row()] += std::abs(d[it.row()] * it.value() * d[j]);
  return sums;
}

StiffestMode dense_spectrum(const LinearOperator& s) {
  const Eigen::MatrixXd matrix = symmetric_part(as_dense(s));
  if (!matrix.allFinite())
    throw std::invalid_argument("the mass-scaled stiffness is not finite, expected finite matrices");
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  StiffestMode mode;
  mode.converged = solver.info() == Eigen::Success;
  if (!mode.converged) return mode;
  mode.value = solver.eigenvalues().tail<1>()[0];
  mode.smallest = solver.eigenvalues()[0];
  Eigen::VectorXd column;
  s.apply(solver.eigenvectors().rightCols<1>(), column);
  column -= mode.value * solver.eigenvectors().rightCols<1>();
  mode.residual = column.stableNorm();
  return mode;
}

void set_mode(const LinearOperator& s, std::complex<double> value, const Eigen::VectorXcd& v,
              StiffestMode& mode) {
  Eigen::VectorXd real, imaginary;
  s.apply(v.real(), real);
  s.apply(v.imag(), imaginary);
  real -= (value * v).real();
  imaginary -= (value * v).imag();
  mode.value = std::abs(value);
  mode.residual = std::hypot(real.stableNorm(), imaginary.stableNorm());
}

// The eigenvalue of largest modulus by ARPACK. A restarted search with few vectors may settle on a neighbour
// of it and converge there. So several eigenvalues are asked for, from several starts, and the largest
// modulus counts as found once two starts have it.
StiffestMode dominant_mode(const LinearOperator& s, ArpackOptions options) {
  constexpr Eigen::Index wanted = 8;
  constexpr int most_starts = 5;
  options.basis_size = std::max<Eigen::Index>(options.basis_size, 6 * wanted);
  StiffestMode best;
  for (int start = 0; start < most_starts && !best.converged; ++start, ++options.seed, options.start = {}) {
    const Eigenvalues found = dominant_eigenvalues(s, wanted, options);
    best.products += found.products;
    if (!found.converged) continue;
    StiffestMode mode;
    set_mode(s, found.values[0], found.vectors.col(0), mode);
    const bool agree = std::abs(mode.value - best.value) <= least_accuracy * mode.value;
    if (mode.value > best.value) best.value = mode.value, best.residual = mode.residual;
    best.converged = start > 0 && agree;
  }
  return best;
}

// For a matrix that is not symmetric: the eigenvalue of largest modulus and, where all are computed, the
// least real part.
StiffestMode nonsymmetric_spectrum(const LinearOperator& s, const ArpackOptions& options) {
  StiffestMode mode;
  if (s.size > nonsymmetric_limit) {
    mode = dominant_mode(s, options);
  } else {
    const Eigen::MatrixXd matrix = as_dense(s);
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
    mode.converged = solver.info() == Eigen::Success;
    if (!mode.converged) return mode;
    Eigen::Index largest = 0;
    solver.eigenvalues().cwiseAbs().maxCoeff(&largest);
    set_mode(s, solver.eigenvalues()[largest], solver.eigenvectors().col(largest).normalized(), mode);
    mode.smallest = solver.eigenvalues().real().minCoeff();
  }
  mode.converged = mode.converged && mode.residual <= least_accuracy * mode.value;
  return mode;
}

StiffestMode arpack_spectrum(const LinearOperator& s, const ArpackOptions& options) {
  const bool few_digits = s.size >= many_unknowns && options.tolerance >= lanczos_tolerance;
  SymmetricEigenpairs pairs;
  if (few_digits) pairs = largest_by_lanczos(s, options, false);
  StiffestMode mode;
  mode.products = pairs.products;
  if (!pairs.converged) pairs = largest_eigenpair(s, options), mode.products += pairs.products;
  mode.converged = pairs.converged;
  if (!pairs.converged) return mode;
  mode.value = pairs.values[0];
  mode.residual = pairs.residuals[0];
  return mode;
}

// The largest entry of M^-½ A M^-½, without its sign.
double largest_scaled_entry(const SparseMatrix& a, const Eigen::VectorXd& inverse_root) {
  double largest = 0;
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      largest = std::max(largest, inverse_root[it.row()] * std::abs(it.value()) * inverse_root[j]);
  return largest;
}

// With damping, or without symmetry, powers up to the fourth of the rates are formed.
void expect_within_double_precision(const StructuralMatrices& s) {
  const Eigen::VectorXd root = inverse_root(s.mass);
  const double k = largest_scaled_entry(s.stiffness, root);
  const double d = s.has_damping() ? largest_scaled_entry(s.damping, root) : 0;
  const bool plain = s.symmetric && !s.has_damping();
  const double least = plain ? std::numeric_limits<double>::denorm_min() : 1e-75;
  const double most = plain ? std::numeric_limits<double>::max() : 1e75;
  const double rate = plain ? k : std::max(std::sqrt(k), d);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(s.size());
  const bool none =
      largest_scaled_entry(s.stiffness, ones) == 0 && largest_scaled_entry(s.damping, ones) == 0;
  if (none || (rate >= least && rate <= most)) return;
  std::ostringstream message;
  message << (plain ? "the largest mass-scaled stiffness is " : "the largest rate of motion is ") << rate
          << (plain ? " 1/s²" : " 1/s") << ", expected " << least << " to " << most
          << "; take a unit of time nearer to it";
  throw std::invalid_argument(message.str());
}

void find_lowest(const StructuralMatrices& s, const ArpackOptions& options, DefinitenessProof& proof,
                 StiffestMode& mode) {
  if (!proof.factorizes()) return;
  mode.indefinite = !proof.stiffness_is_semidefinite();
  if (!mode.indefinite) return;
  mode.lowest = mode.smallest;
  if (mode.lowest) return;
  const LinearOperator k = scaled_stiffness(s);
  const LinearOperator negative{k.size,
                                [&k](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
                                  k.apply(in, out);
                                  out = -out;
                                },
                                -k.highest, -k.lowest};
  constexpr int patience = 300;  // restarts: a soft end among many is not worth more
  ArpackOptions few = options;
  few.max_restarts = std::min(few.max_restarts, patience);
  const SymmetricEigenpairs pairs = largest_eigenpair(negative, few);
  mode.products += pairs.products;
  if (pairs.converged) mode.lowest = -pairs.values[0];
}

// Of a symmetric matrix with this diagonal and these absolute row sums; without its product.
LinearOperator bounded_by_discs(const Eigen::VectorXd& centres, const Eigen::VectorXd& sums) {
  const Eigen::VectorXd radii = sums - centres.cwiseAbs();
  return {centres.size(), {}, (centres - radii).minCoeff(), (centres + radii).maxCoeff()};
}

auto product_with(BlockSparseMatrix blocks) {
  return [matrix = std::make_shared<const BlockSparseMatrix>(std::move(blocks))](const Eigen::VectorXd& in,
                                                                                 Eigen::VectorXd& out) {
    out.resize(in.size());
    matrix->multiply(in.data(), out.data());
  };
}

// Both calls, on two threads; of their exceptions the first one's comes first.
template <class First, class Second>
void both_at_once(const First& first, const Second& second) {
  std::exception_ptr thrown[2];
  share(2, [&](int part) {
    try {
      part == 0 ? first() : second();
    } catch (...) {
      thrown[part] = std::current_exception();
    }
  });
  for (const std::exception_ptr& exception : thrown)
    if (exception) std::rethrow_exception(exception);
}

}  // namespace

LinearOperator symmetric_operator(SparseMatrix a) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(a.cols());
  LinearOperator op = bounded_by_discs(a.diagonal(), a.cwiseAbs() * ones);
  if (op.size >= many_unknowns)
    if (std::optional<BlockSparseMatrix> blocks = in_blocks(a)) {
      op.apply = product_with(std::move(*blocks));
      return op;
    }
  const auto matrix = std::make_shared<const SparseMatrix>(std::move(a));
  if (op.size < many_unknowns) {
    op.apply = [matrix](const Eigen::VectorXd& in, Eigen::VectorXd& out) { out.noalias() = *matrix * in; };
  } else {  // row by row, which reads `out` but once
    const double row_cost = 0.5 * static_cast<double>(matrix->nonZeros() / op.size);  // [ns]
    op.apply = [matrix, row_cost](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
      out.resize(in.size());
      share_range(in.size(), row_cost, [&](long first, long last) {
        out.segment(first, last - first).noalias() = matrix->middleCols(first, last - first).transpose() * in;
      });
    };
  }
  return op;
}

// With a diagonal mass it is a matrix; else L⁻¹ P A Pᵀ L⁻ᵀ with P M Pᵀ = LLᵀ. What becomes blocks has no copy
// of single numbers beside.
LinearOperator mass_scaled(const SparseMatrix& a, const SparseMatrix& mass) {
  if (is_diagonal(mass)) {
    const Eigen::VectorXd root = inverse_root(mass);
    if (a.rows() >= many_unknowns)
      if (std::optional<BlockSparseMatrix> blocks = in_blocks(a)) {
        blocks->scale(root);
        const Eigen::VectorXd centres = root.cwiseProduct(a.diagonal()).cwiseProduct(root);
        LinearOperator op = bounded_by_discs(centres, scaled_row_sums(a, root));
        op.apply = product_with(std::move(*blocks));
        return op;
      }
    return symmetric_operator(scaled(a, root));
  }
  const auto factor = std::make_shared<Cholesky>(mass);
  return {a.rows(), [factor, &a](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
            out = factor->permutationPinv() * factor->matrixU().solve(in);
            out = factor->permutationP() * (a * out).eval();
            factor->matrixL().solveInPlace(out);
          }};
}

LinearOperator scaled_stiffness(const StructuralMatrices& s) { return mass_scaled(s.stiffness, s.mass); }

Eigen::MatrixXd as_dense(const LinearOperator& a) {
  Eigen::MatrixXd matrix(a.size, a.size);
  Eigen::VectorXd column;
  for (Eigen::Index j = 0; j < a.size; ++j) {
    a.apply(Eigen::VectorXd::Unit(a.size, j), column);
    matrix.col(j) = column;
  }
  return matrix;
}

Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& a) { return 0.5 * (a + a.transpose()); }

bool is_below(const StructuralMatrices& s, double sigma) {
  return DefinitenessProof(s.stiffness, s.mass).holds(sigma, 0, 1);
}

StiffestMode estimated_stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options) {
  expect_within_double_precision(s);
  const LinearOperator op = scaled_stiffness(s);
  StiffestMode mode = !s.symmetric              ? nonsymmetric_spectrum(op, options)
                      : s.size() <= dense_limit ? dense_spectrum(op)
                                                : arpack_spectrum(op, options);
  mode.upper_bound = infinity;
  return mode;
}

void find_lowest(const StructuralMatrices& s, const ArpackOptions& options, StiffestMode& mode) {
  if (!mode.converged || !s.symmetric) return;
  DefinitenessProof proof(s.stiffness, s.mass);
  find_lowest(s, options, proof, mode);
}

void tighten_bound(StiffestMode& mode, double gap, const std::function<bool(double)>& proves,
                   const std::function<BoundKind()>& kind) {
  while (mode.value + gap < mode.upper_bound && !proves(mode.value + gap))
    gap *= kind() == BoundKind::pieces ? 2 : 8;
  if (!(mode.value + gap < mode.upper_bound)) return;
  mode.upper_bound = mode.value + gap;
  mode.bound_kind = kind();
}

StiffestMode stiffest_mode(const StructuralMatrices& s, const ArpackOptions& options, double loss) {
  StiffestMode mode;
  const SparseMatrix* const damping =
      s.has_damping() ? &s.damping : nullptr;  // later proofs share its pattern
  std::optional<DefinitenessProof> proof;
  const auto find = [&] { mode = estimated_stiffest_mode(s, options); };
  const bool factorized_at_once = s.size() >= many_unknowns && s.size() <= SparseCholesky::unknowns_limit;
  if (s.symmetric && factorized_at_once && loop_threads() > 1) {
    both_at_once(find, [&] {
      proof.emplace(s.stiffness, s.mass, damping, loss);
      if (proof->factorizes()) proof->stiffness_is_semidefinite();
    });
  } else {
    find();
  }
  if (is_diagonal(s.mass)) {
    mode.gershgorin = scaled_row_sums(s.stiffness, inverse_root(s.mass)).maxCoeff() *
                      (1 + 8 * unit_roundoff * static_cast<double>(s.size()));
    mode.upper_bound = mode.gershgorin;
  }
  if (!mode.converged || !s.symmetric) return mode;

  if (!proof) proof.emplace(s.stiffness, s.mass, damping, loss);
  find_lowest(s, options, *proof, mode);
  const double scale = std::abs(mode.value);
  if (scale == 0) return mode;
  double gap = std::max(mode.residual, 1e-10 * scale);
  if (!proof->factorizes()) gap = std::max(gap, loss * scale);
  tighten_bound(
      mode, gap, [&](double sigma) { return proof->holds(sigma, 0, 1); },
      [&] { return proof->pieces() > 0 ? BoundKind::pieces : BoundKind::inertia; });
  return mode;
}

}  // namespace springstab
