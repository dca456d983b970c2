#include "analysis/limits/mass_scaling.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "analysis/proofs/definiteness.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

constexpr double surplus = 1e-8;  // of N

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The dual, climbed from a random start.
class MassDual {
 public:
  MassDual(const SparseMatrix& q, int width) : q_(q), width_(width), tau_(q.rows() / width) {
    const auto particles = static_cast<double>(tau_.size());
    const auto rank =
        std::min<Eigen::Index>(most_columns, 2 + static_cast<Eigen::Index>(std::sqrt(2 * particles)));
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    v_ = Rows::NullaryExpr(q.rows(), rank, [&] { return normal(random); });
    for (Eigen::Index p = 0; p < tau_.size(); ++p) {
      v_.middleRows(p * width, width).normalize();
      Eigen::MatrixXd block = Eigen::MatrixXd(q.block(p * width, p * width, width, width));
      blocks_.emplace_back(block);
    }
  }

  /// One particle after another, until the value rises by less than 1e-7 of it in ten rounds.
  void climb() {
    const double work = static_cast<double>(q_.nonZeros() * v_.cols());
    const int most = static_cast<int>(std::clamp(most_work / work, 20.0, 3000.0));
    double before = value();
    for (int round = 1; round <= most; ++round) {
      for (Eigen::Index p = 0; p < tau_.size(); ++p) improve(p);
      if (round % 10 != 0) continue;
      const double now = value();
      if (now - before <= 1e-7 * std::abs(now)) break;
      before = now;
    }
  }

  double value() const { return -(v_.cwiseProduct(q_ * v_)).sum(); }
  const Eigen::VectorXd& multipliers() const { return tau_; }

 private:
  static constexpr Eigen::Index most_columns = 12;
  static constexpr double most_work = 1e10;

  // V_p = -(Q_pp + τ I)⁻¹ G with |V_p| <= 1, τ >= 0 and τ (1 - |V_p|) = 0.
  void improve(Eigen::Index p) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& block = blocks_[static_cast<std::size_t>(p)];
    Rows g = Rows::Zero(width_, v_.cols());
    for (int r = 0; r < width_; ++r)
      for (SparseMatrix::InnerIterator it(q_, p * width_ + r); it; ++it)
        if (it.row() / width_ != p) g.row(r) += it.value() * v_.row(it.row());
    g = (block.eigenvectors().transpose() * g).eval();
    const Eigen::ArrayXd size = g.rowwise().norm().array(), k = block.eigenvalues().array();
    double tau = std::max({0.0, -k.minCoeff(), (size - k).maxCoeff()});
    if (k.minCoeff() > 0 && (size / k).matrix().norm() <= 1) tau = 0;
    // 1 - 1/|V_p(τ)| rises and is concave: Newton's steps come from below and do not pass the root.
    for (int i = 0; tau > 0 && i < 30; ++i) {
      const Eigen::ArrayXd shifted = (k + tau).max(1e-15 * (k + tau).abs().maxCoeff());
      const double norm = (size / shifted).matrix().norm();
      const double slope = (size.square() / shifted.cube()).sum() / (norm * norm * norm);
      const double step = (norm - 1) / norm / slope;
      if (!(step > 1e-14 * tau) || !std::isfinite(step)) break;
      tau += step;
    }
    set_row(p, block.eigenvectors(), g, k + tau);
    tau_[p] = tau;
  }

  // Where nothing pulls along the softest direction, it is as long as the others leave room.
  void set_row(Eigen::Index p, const Eigen::MatrixXd& axes, Rows& g, const Eigen::ArrayXd& shifted) {
    const double scale = std::max(shifted.abs().maxCoeff(), 1e-300);
    for (int r = 0; r < width_; ++r) g.row(r) *= shifted[r] > 1e-14 * scale ? -1 / shifted[r] : 0;
    const double rest = 1 - g.squaredNorm();
    if (shifted[0] <= 1e-14 * scale && rest > 0) g.row(0).setUnit(p % v_.cols()), g.row(0) *= std::sqrt(rest);
    v_.middleRows(p * width_, width_) = axes * g;
  }

  const SparseMatrix& q_;
  int width_;
  Eigen::VectorXd tau_;
  Rows v_;
  std::vector<Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>> blocks_;
};

Eigen::VectorXd spread(const Eigen::VectorXd& of_particles, int width) {
  Eigen::VectorXd all(of_particles.size() * width);
  for (Eigen::Index i = 0; i < all.size(); ++i) all[i] = of_particles[i / width];
  return all;
}

// What makes every row of Q dominant.
Eigen::VectorXd by_row_sums(const SparseMatrix& q, int width) {
  const Eigen::VectorXd diagonal = q.diagonal();
  const Eigen::VectorXd sums = q.cwiseAbs() * Eigen::VectorXd::Ones(q.cols()) - diagonal.cwiseAbs();
  Eigen::VectorXd lacking = Eigen::VectorXd::Zero(q.rows() / width);
  for (Eigen::Index i = 0; i < q.rows(); ++i)
    lacking[i / width] = std::max(lacking[i / width], sums[i] - diagonal[i]);
  return lacking;
}

}  // namespace

Eigen::VectorXd MassScaling::of_unknowns(Eigen::Index n, int width) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(n);
  for (const Added& each : particles) all.segment(each.particle * width, width).setConstant(each.mass);
  return all;
}

MassScaling scale_masses(const SparseMatrix& mass, const SparseMatrix& n, double c, int width) {
  if (!(c > 0) || width < 1 || mass.rows() % width != 0)
    throw std::invalid_argument(
        "masses are to be scaled for c = " + std::to_string(c) + " and " + std::to_string(width) +
        " unknowns a particle, expected c > 0 and a divisor of " + std::to_string(mass.rows()));
  const SparseMatrix more = (1 + surplus) * n, q = c * mass - more;
  MassDual dual(q, width);
  dual.climb();
  const auto holds = [&](const Eigen::VectorXd& tau) {
    const SparseMatrix heavier = mass + SparseMatrix((spread(tau, width) / c).asDiagonal());
    return DefinitenessProof(more, heavier).holds(c, 0, 1);
  };

  // The multipliers themselves are on the border, and some way off it as long as V is.
  MassScaling scaling;
  Eigen::VectorXd tau = dual.multipliers();
  tau = (tau.array() > 1e-9 * tau.maxCoeff()).select(tau, 0.0).eval();
  double more_of_it = 1e-9;
  const auto lifted = [&] { return ((1 + more_of_it) * tau).eval(); };
  while (!(scaling.proved = holds(lifted())) && more_of_it < 0.5) more_of_it *= 4;
  tau = lifted();
  if (!scaling.proved || tau.sum() > by_row_sums(q, width).sum()) {
    tau = (1 + surplus) * by_row_sums(q, width);
    scaling.proved = holds(tau);
  }
  for (Eigen::Index p = 0; p < tau.size(); ++p)
    if (tau[p] > 0) scaling.particles.push_back({static_cast<long>(p), tau[p] / c});
  scaling.added_mass = tau.sum() / c;
  scaling.least = std::max(dual.value(), 0.0) / c;
  return scaling;
}

}  // namespace springstab
