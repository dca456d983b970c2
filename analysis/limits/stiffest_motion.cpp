#include "analysis/limits/stiffest_motion.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "analysis/spectra/numerical_range.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

constexpr std::size_t most_carriers = 10;

// From the eigenvector u of S, φ = M^-½ u, or L⁻ᵀu with M = LLᵀ as S is made (spectra/spectrum.h).
std::optional<Eigen::VectorXd> stiffest_mode_shape(const StructuralMatrices& s,
                                                   const ArpackOptions& options) {
  const StructuralMatrices undamped{s.stiffness, s.mass, {}};
  const std::optional<ExtremePoint> top = NumericalRange(undamped, options).farthest(0, 1);
  if (!top || !(top->k > 0)) return std::nullopt;
  Eigen::VectorXd mode;
  if (is_diagonal(s.mass)) {
    mode = top->vector.array() / s.mass.diagonal().array().sqrt();
  } else {
    const Eigen::SimplicialLLT<SparseMatrix> factor(s.mass);
    mode = factor.permutationPinv() * factor.matrixU().solve(top->vector);
  }
  Eigen::Index largest = 0;
  mode.cwiseAbs().maxCoeff(&largest);
  return Eigen::VectorXd((mode[largest] < 0 ? -1 : 1) / std::sqrt(mode.dot(s.mass * mode)) * mode);
}

// Keeps the ten largest shares, of equal ones the first.
void keep_largest(Carrier carrier, std::vector<Carrier>& carriers) {
  if (carriers.size() == most_carriers && !(carrier.share > carriers.back().share)) return;
  const auto place = std::ranges::upper_bound(carriers, carrier.share, std::greater<>(), &Carrier::share);
  carriers.insert(place, std::move(carrier));
  if (carriers.size() > most_carriers) carriers.pop_back();
}

double largest_eigenvalue(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues().tail<1>()[0];
}

// Of an element, what can move: its places and its matrix between them.
struct FreePart {
  std::vector<int> place;
  Eigen::MatrixXd stiffness;

  FreePart(const std::vector<int>& places, std::span<const int> particles, const Eigen::MatrixXd& k) {
    std::vector<Eigen::Index> rows;
    for (std::size_t c = 0; c < particles.size(); ++c) {
      const int p = places[static_cast<std::size_t>(particles[c])];
      if (p < 0) continue;
      place.push_back(p);
      for (Eigen::Index r = 0; r < 3; ++r) rows.push_back(3 * static_cast<Eigen::Index>(c) + r);
    }
    stiffness = k(rows, rows);
  }
  Eigen::Index corners() const { return std::ssize(place); }
  double weight(Eigen::Index corner) const { return stiffness.middleRows(3 * corner, 3).norm(); }
};

void add_elements(const StructuralMatrices& s, const ElementsOf& elements, double k0,
                  StiffestMotion& motion) {
  const Eigen::VectorXd mass = s.mass.diagonal();
  std::vector<double> weights(static_cast<std::size_t>(s.size() / 3));
  elements.visit_all([&](std::string_view, long, std::span<const int> particles, const Eigen::MatrixXd& k) {
    const FreePart part(elements.place, particles, k);
    for (Eigen::Index c = 0; c < part.corners(); ++c) weights[part.place[c]] += part.weight(c);
  });
  double bound = 0;
  elements.visit_all([&](std::string_view kind, long index, std::span<const int> particles,
                         const Eigen::MatrixXd& k) {
    const FreePart part(elements.place, particles, k);
    if (part.corners() == 0) return;
    Eigen::VectorXd u(3 * part.corners()), root(3 * part.corners());
    double weighs = 0;
    for (Eigen::Index c = 0; c < part.corners(); ++c) {
      const Eigen::Index p = 3 * static_cast<Eigen::Index>(part.place[c]);
      const double own = part.weight(c) / weights[part.place[c]];
      u.segment<3>(3 * c) = motion.mode.segment<3>(p);
      root.segment<3>(3 * c).setConstant(own > 0 ? 1 / std::sqrt(own * mass[p]) : 0);
      weighs += mass[p];
    }
    bound = std::max(bound, largest_eigenvalue(root.asDiagonal() * part.stiffness * root.asDiagonal()));
    const double share = u.dot(part.stiffness * u) / k0;
    if (motion.carriers.size() < most_carriers || share > motion.carriers.back().share)
      keep_largest({kind, index, {particles.begin(), particles.end()}, share, largest_eigenvalue(k), weighs},
                   motion.carriers);
  });
  motion.element = bound;
}

}  // namespace

std::optional<StiffestMotion> stiffest_motion(const StructuralMatrices& s,
                                              const std::optional<ElementsOf>& elements,
                                              const ArpackOptions& options) {
  if (!s.symmetric) return std::nullopt;
  std::optional<Eigen::VectorXd> mode = stiffest_mode_shape(s, options);
  if (!mode) return std::nullopt;
  StiffestMotion motion{std::move(*mode), {}, {}, {}};
  const Eigen::VectorXd force = s.stiffness * motion.mode, mass = s.mass.diagonal(),
                        stiffness = s.stiffness.diagonal();
  const double k0 = motion.mode.dot(force);
  if (is_diagonal(s.mass))
    motion.nodal =
        ((s.stiffness.cwiseAbs() * Eigen::VectorXd::Ones(s.size())).array() / mass.array()).maxCoeff();
  if (elements) {
    add_elements(s, *elements, k0, motion);
  } else {
    for (Eigen::Index i = 0; i < s.size(); ++i)
      keep_largest({"unknown",
                    static_cast<long>(i),
                    {static_cast<int>(i)},
                    motion.mode[i] * force[i] / k0,
                    stiffness[i],
                    mass[i]},
                   motion.carriers);
  }
  return motion;
}

}  // namespace springstab
