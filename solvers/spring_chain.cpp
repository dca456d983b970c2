#include "solvers/spring_chain.h"

#include <sstream>
#include <stdexcept>

namespace springstab {

SpringChain::SpringChain(const std::vector<double>& mass, const std::vector<double>& stiffness,
                         RayleighDamping damping)
    : mass_(Eigen::Map<const Vector>(mass.data(), static_cast<Eigen::Index>(mass.size()))),
      inverse_mass_(mass_.cwiseInverse()),
      stiffness_(Eigen::Map<const Vector>(stiffness.data(), static_cast<Eigen::Index>(stiffness.size()))),
      damping_(damping),
      tension_(stiffness_.size()) {
  if (mass.empty() || stiffness.size() != mass.size() + 1) {
    std::ostringstream message;
    message << "a chain of " << mass.size() << " masses and " << stiffness.size()
            << " springs, expected one spring more than masses";
    throw std::invalid_argument(message.str());
  }
  if (!(mass_.minCoeff() > 0 && mass_.allFinite()))
    throw std::invalid_argument("a mass of the chain is not positive and finite");
  if (!(stiffness_.minCoeff() >= 0 && stiffness_.allFinite()))
    throw std::invalid_argument("a spring of the chain has a negative or infinite stiffness");
}

void SpringChain::set_damping(const RayleighDamping& damping) {
  damping_ = damping;
  factorized_.reset();
}

StructuralMatrices SpringChain::matrices() const {
  const Eigen::Index n = size();
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, stiffness_[i] + stiffness_[i + 1]);
    if (i + 1 == n) break;
    entries.emplace_back(i, i + 1, -stiffness_[i + 1]);
    entries.emplace_back(i + 1, i, -stiffness_[i + 1]);
  }
  SparseMatrix k(n, n);
  k.setFromTriplets(entries.begin(), entries.end());
  return prepare(k, SparseMatrix(mass_.asDiagonal()));
}

// The tensions for displacements u.
void SpringChain::stretch(const Vector& u) {
  const Eigen::Index n = size();
  tension_[0] = stiffness_[0] * u[0];
  tension_.segment(1, n - 1) =
      stiffness_.segment(1, n - 1).cwiseProduct(u.segment(1, n - 1) - u.segment(0, n - 1));
  tension_[n] = -stiffness_[n] * u[n - 1];
}

void SpringChain::acceleration(const Vector& x, const Vector& v, Vector& out) {
  if (damping_.alpha != 0) {
    sum_ = x + damping_.alpha * v;
    stretch(sum_);
  } else {
    stretch(x);
  }
  const Eigen::Index n = size();
  out = (tension_.segment(1, n) - tension_.segment(0, n)).cwiseProduct(inverse_mass_) - damping_.d0 * v;
}

void SpringChain::stiffness_times(const Vector& u, Vector& out) {
  stretch(u);
  const Eigen::Index n = size();
  out = (tension_.segment(0, n) - tension_.segment(1, n)).cwiseProduct(inverse_mass_);
}

void SpringChain::damping_times(const Vector& u, Vector& out) {
  stiffness_times(u, out);
  out = damping_.alpha * out + damping_.d0 * u;
}

StepStatus SpringChain::factorize(const Shift& shift) {
  if (shift == factorized_) return StepStatus::done;
  factorized_.reset();
  const Eigen::Index n = size();
  const double of_mass = shift.mass + shift.damping * damping_.d0,
               of_stiffness = shift.damping * damping_.alpha + shift.stiffness;
  pivot_inverse_.resize(n);
  factor_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double beside = -of_stiffness * stiffness_[i];
    double pivot = of_mass * mass_[i] + of_stiffness * (stiffness_[i] + stiffness_[i + 1]);
    factor_[i] = i > 0 ? beside * pivot_inverse_[i - 1] : 0;
    if (i > 0) pivot -= beside * factor_[i];
    if (!(pivot > 0)) return StepStatus::not_positive_definite;
    pivot_inverse_[i] = 1 / pivot;
  }
  factorized_ = shift;
  return StepStatus::done;
}

SolveReport SpringChain::solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) {
  SolveReport report{factorize(shift), 0, 1};
  if (report.status != StepStatus::done) return report;
  const Eigen::Index n = size();
  out = mass_.cwiseProduct(rhs);
  for (Eigen::Index i = 1; i < n; ++i) out[i] -= factor_[i] * out[i - 1];
  out = out.cwiseProduct(pivot_inverse_);
  for (Eigen::Index i = n - 1; i > 0; --i) out[i - 1] -= factor_[i] * out[i];
  return report;
}

SolveReport SpringChain::solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) {
  if (part == DampingPart::all) return solve_shifted({1, h, 0}, rhs, out);
  const Eigen::Index n = size();
  sum_ = (1 + h * damping_.d0) * mass_ + h * damping_.alpha * (stiffness_.head(n) + stiffness_.tail(n));
  out = mass_.cwiseProduct(rhs).cwiseQuotient(sum_);
  return {};
}

double SpringChain::kinetic_energy(const Vector& v) { return v.cwiseAbs2().dot(mass_) / 2; }

double SpringChain::potential_energy(const Vector& x) {
  stretch(x);
  const Eigen::Index n = size();  // the energies of the springs between masses, and of those to the walls
  return (tension_.segment(1, n - 1).dot(x.segment(1, n - 1) - x.segment(0, n - 1)) + tension_[0] * x[0] -
          tension_[n] * x[n - 1]) /
         2;
}

}  // namespace springstab
