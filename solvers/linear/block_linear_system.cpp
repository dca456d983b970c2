#include "solvers/linear/block_linear_system.h"

#include <Eigen/Cholesky>

namespace springstab {
namespace {

using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

}  // namespace

BlockLinearSystem::BlockLinearSystem(
    std::vector<double> mass, RayleighDamping damping,
    std::span<const std::pair<int, int>> stiffness_couplings,
    std::optional<std::span<const std::pair<int, int>>> own_damping_couplings)
    : mass_(std::move(mass)),
      damping_(damping),
      stiffness_(static_cast<int>(mass_.size()), stiffness_couplings) {
  if (own_damping_couplings) own_damping_.emplace(static_cast<int>(mass_.size()), *own_damping_couplings);
}

template <class Scale>
void BlockLinearSystem::scale_by_mass(Vector& u, Scale scale) const {
  for (std::size_t i = 0; i < mass_.size(); ++i) u.segment<3>(3 * i) *= scale(mass_[i]);
}

void BlockLinearSystem::acceleration(const Vector& x, const Vector& v, Vector& out) {
  out.resize(size());
  if (damping_.alpha == 0) {
    stiffness_.multiply(x.data(), out.data());
  } else {
    w_ = x + damping_.alpha * v;
    stiffness_.multiply(w_.data(), out.data());
  }
  if (own_damping_) {
    product_.resize(size());
    own_damping_->multiply(v.data(), product_.data());
    out += product_;
  }
  scale_by_mass(out, [](double m) { return -1 / m; });
  if (damping_.d0 != 0) out -= damping_.d0 * v;
}

void BlockLinearSystem::stiffness_times(const Vector& u, Vector& out) {
  out.resize(size());
  stiffness_.multiply(u.data(), out.data());
  scale_by_mass(out, [](double m) { return 1 / m; });
}

void BlockLinearSystem::damping_times(const Vector& u, Vector& out) {
  w_.setZero(size());
  acceleration(w_, u, out);
  out = -out;
}

bool BlockLinearSystem::invert_diagonal_blocks(double mass_factor, double stiffness_factor,
                                               double damping_factor) {
  inverse_blocks_.resize(9 * mass_.size());
  for (int i = 0; i < stiffness_.rows(); ++i) {
    Block h = stiffness_factor * Eigen::Map<const Block>(stiffness_.block(stiffness_.diagonal(i)));
    if (own_damping_)
      h += damping_factor * Eigen::Map<const Block>(own_damping_->block(own_damping_->diagonal(i)));
    h.diagonal().array() += mass_factor * mass_[i];
    const Eigen::LLT<Block> factor(h);
    if (factor.info() != Eigen::Success) return false;
    Eigen::Map<Block> inverse(&inverse_blocks_[9 * i]);
    inverse = factor.solve(Block::Identity());
  }
  return true;
}

// M (1 + hD' + h²K') = (1 + h d0) M + (h alpha + h²) K + hC is symmetric.
SolveReport BlockLinearSystem::solve_shifted(double h, const Vector& rhs, Vector& out) {
  const double mass_factor = 1 + h * damping_.d0, stiffness_factor = h * (damping_.alpha + h);
  if (!invert_diagonal_blocks(mass_factor, stiffness_factor, h))
    return {.status = StepStatus::not_positive_definite};

  const auto apply = [&](const Vector& p, Vector& q) {
    q.resize(size());
    stiffness_.multiply(p.data(), q.data());
    for (std::size_t i = 0; i < mass_.size(); ++i)
      q.segment<3>(3 * i) =
          stiffness_factor * q.segment<3>(3 * i) + mass_factor * mass_[i] * p.segment<3>(3 * i);
    if (own_damping_) {
      product_.resize(size());
      own_damping_->multiply(p.data(), product_.data());
      q += h * product_;
    }
  };
  const auto precondition = [&](const Vector& r, Vector& z) {
    z.resize(size());
    for (std::size_t i = 0; i < mass_.size(); ++i)
      z.segment<3>(3 * i) = Eigen::Map<const Block>(&inverse_blocks_[9 * i]) * r.segment<3>(3 * i);
  };
  rhs_ = rhs;
  scale_by_mass(rhs_, [](double m) { return m; });
  SolveReport report = conjugate_gradient_.solve(apply, precondition, rhs_, out, solver);
  report.products = report.iterations * (own_damping_ ? 2 : 1);
  return report;
}

double BlockLinearSystem::kinetic_energy(const Vector& v) {
  double sum = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i) sum += mass_[i] * v.segment<3>(3 * i).squaredNorm();
  return sum / 2;
}

double BlockLinearSystem::potential_energy(const Vector& x) {
  product_.resize(size());
  stiffness_.multiply(x.data(), product_.data());
  return x.dot(product_) / 2;
}

}  // namespace springstab
