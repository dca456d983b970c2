#include "analysis/diagnosis/growing_component.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace springstab::diagnosis {
namespace {

constexpr Eigen::Index most_pairs = 24, most_directions = 6;
constexpr double told_apart = 1e-3;  // a direction counts, relative to the strongest
constexpr double as_good = 1.5;      // a residual, beside the best: then the fewest directions explain it

// The matrices of a window, with every pair scaled to unit norm: Z = (first; second), Z' = (second; third).
struct Pairs {
  Eigen::MatrixXd first, second, third;  // n x m
  Eigen::MatrixXd products, carried;     // ZᵀZ and ZᵀZ'
  double next;                           // ‖Z'‖²
};

std::optional<Pairs> pairs_of(const Frames& frames, const GrowthWindow& window) {
  const Eigen::Index starts = window.end - window.begin - 2 * window.lag;
  const Eigen::Index m = std::min(starts, most_pairs);
  if (m < 3) return std::nullopt;
  Pairs p{Eigen::MatrixXd(frames.rows(), m),
          Eigen::MatrixXd(frames.rows(), m),
          Eigen::MatrixXd(frames.rows(), m),
          {},
          {},
          0};
  for (Eigen::Index j = 0; j < m; ++j) {
    const Eigen::Index n = window.begin + j * (starts - 1) / (m - 1);
    p.first.col(j) = difference(frames, window.order, n);
    p.second.col(j) = difference(frames, window.order, n + window.lag);
    p.third.col(j) = difference(frames, window.order, n + 2 * window.lag);
    const double norm = std::hypot(p.first.col(j).norm(), p.second.col(j).norm());
    if (!(norm > 0)) return std::nullopt;
    for (Eigen::MatrixXd* part : {&p.first, &p.second, &p.third}) part->col(j) /= norm;
  }
  p.products = p.first.transpose() * p.first + p.second.transpose() * p.second;
  p.carried = p.first.transpose() * p.second + p.second.transpose() * p.third;
  p.next = p.second.squaredNorm() + p.third.squaredNorm();
  return p;
}

// Z = U S Vᵀ by its products, of which the strong directions are kept, the strongest first: the columns of
// V S⁻¹, so that U = Z times these.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& products) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(products);
  const Eigen::VectorXd squares = solver.eigenvalues().reverse();
  const Eigen::Index most = std::min(most_directions, squares.size() / 2);
  Eigen::Index kept = 1;
  while (kept < most && squares[kept] > told_apart * told_apart * squares[0]) ++kept;
  return solver.eigenvectors().rowwise().reverse().leftCols(kept) *
         squares.head(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

// A in the space of the basis, UᵀAU, and ‖Z' - A Z‖/‖Z'‖.
struct Reduced {
  Eigen::MatrixXd matrix, inside;  // inside = UᵀZ
  double residual;
};

Reduced reduced_to(const Pairs& pairs, const Eigen::MatrixXd& basis) {
  const Eigen::MatrixXd carried = basis.transpose() * pairs.carried;  // UᵀZ'
  Reduced r{carried * basis, basis.transpose() * pairs.products, 0};
  const Eigen::MatrixXd explained = r.matrix * r.inside;
  const double left = pairs.next - 2 * carried.cwiseProduct(explained).sum() + explained.squaredNorm();
  r.residual = std::sqrt(std::max(0.0, left / pairs.next));
  return r;
}

}  // namespace

Eigen::VectorXd difference(const Frames& frames, int order, Eigen::Index n) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(frames.rows());
  double binomial = 1;  // (-1)^j C(p, j), from the newest frame back
  for (int j = 0; j <= order; ++j) {
    y += binomial * frames.col(n + order - j);
    binomial *= -static_cast<double>(order - j) / (j + 1);
  }
  return y;
}

std::optional<GrowingComponent> growing_component(const Frames& frames, const GrowthWindow& window) {
  const std::optional<Pairs> pairs = pairs_of(frames, window);
  if (!pairs) return std::nullopt;
  const Eigen::MatrixXd whole = basis_of(pairs->products);
  const double best = reduced_to(*pairs, whole).residual;
  Eigen::Index rank = 1;
  while (rank < whole.cols() && reduced_to(*pairs, whole.leftCols(rank)).residual > as_good * best) ++rank;
  const Eigen::MatrixXd basis = whole.leftCols(rank);
  const auto [reduced, inside, residual] = reduced_to(*pairs, basis);
  if (!reduced.allFinite()) return std::nullopt;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(reduced);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXcd right = solver.eigenvectors(), left = right.inverse();

  const Eigen::Index last = inside.cols() - 1;
  Eigen::Index growing = -1;
  double share = 0;
  for (Eigen::Index i = 0; i < right.cols(); ++i) {
    const std::complex<double> value = solver.eigenvalues()[i];
    if (!(std::abs(value) > 1) || value.imag() < 0) continue;
    const std::complex<double> amplitude = left.row(i) * inside.col(last);
    // A conjugate pair is one motion, 2 Re(...).
    const Eigen::VectorXcd part = amplitude * right.col(i);
    const double of_it = value.imag() > 0 ? 2 * part.real().norm() : part.norm();
    if (of_it > share) growing = i, share = of_it;
  }
  if (growing < 0) return std::nullopt;
  GrowingComponent found;
  const Eigen::VectorXcd functional = basis * left.row(growing).transpose();
  found.pattern = pairs->first * (basis * right.col(growing));
  if (!(found.pattern.norm() > 0)) return std::nullopt;
  found.pattern.normalize();
  found.now = pairs->first * functional;
  found.late = pairs->second * functional;
  found.share = share;
  found.residual = residual;
  return found;
}

}  // namespace springstab::diagnosis
