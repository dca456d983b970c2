// Impulses between places of surfaces: of a contact of up to four nodes with weights w, Σ w = 0, the
// velocity at which its two places part is Σ w v, and an impulse p at it changes each node's v by w p / m.
// With normals n and least velocities b <= 0,
//     v ← v + M⁻¹ Σ w (r n + q),   0 <= r ⟂ n·Σ w v - b >= 0,   q: friction.h,
// which without friction is the nearest v in the mass norm that obeys all contacts, by projected
// Gauss–Seidel: one contact after the other, in their order, those that share a node with each other by
// themselves. As many contacts as surfaces have ask for almost the same of a few nodes, which it would settle
// only slowly: what a sweep has changed is taken for a gradient, and the next one starts from where conjugate
// gradients would be (after Silcowitz, Niebe and Erleben 2010).
//
// A sweep by itself takes from ½rᵀAr + rᵀ(Gv₀ - b), 0 at r = 0, so that, wherever it ends, kinetic energy has
// not grown: it changed by at most rᵀb <= 0. With what is between sweeps, and with friction, that is seen to
// at the end: where it has grown, the impulses are taken back for those of sweeps alone, without friction.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace springstab {

struct PairContact {
  std::array<int, 4> nodes;
  std::array<double, 4> weights;
  Eigen::Vector3d normal;
  double bound;                                 // b [m/s]
  Eigen::Vector3d slip_before = {0, 0, 0};      // with which the step began (friction.h) [m/s]
  double r = 0;                                 // [N·s]
  Eigen::Vector3d q = Eigen::Vector3d::Zero();  // [N·s]
  double mobility = 0;                          // Σ w²/m [1/kg], set by solve
};

/// Σ w u of what the nodes have.
inline Eigen::Vector3d parting(const PairContact& c, std::span<const Eigen::Vector3d> u) {
  Eigen::Vector3d sum = c.weights[0] * u[c.nodes[0]];
  for (int k = 1; k < 4; ++k)
    if (c.weights[k] != 0) sum += c.weights[k] * u[c.nodes[k]];
  return sum;
}

class CoupledImpulses {
 public:
  /// Of all nodes, 0 of what cannot be moved [1/kg].
  explicit CoupledImpulses(std::vector<double> inverse_mass)
      : inverse_mass_(std::move(inverse_mass)),
        parent_(inverse_mass_.size()),
        group_(inverse_mass_.size()),
        before_(inverse_mass_.size()) {}

  double inverse_mass(int node) const { return inverse_mass_[node]; }

  /// From r = q = 0. Whether it has settled: an impulse of the last sweep changed no velocity by more than a
  /// 1e-5th of the fastest that any contact has or asks for. Contacts of what cannot be moved are left alone.
  bool solve(std::span<PairContact> contacts, double friction, std::span<Eigen::Vector3d> v);
  long sweeps() const { return sweeps_; }  // in all calls together, of those that took most

 private:
  /// Contacts that share nodes which can be moved, with each other and with no others.
  using Coupled = std::span<PairContact* const>;
  struct Impulse {
    double r = 0;
    Eigen::Vector3d q = Eigen::Vector3d::Zero();
  };

  void group(std::span<PairContact> contacts);
  int root(int node);
  bool settle(Coupled coupled, double friction, double still, std::span<Eigen::Vector3d> v);
  bool sweep(Coupled coupled, double friction, double still, bool conjugate, std::span<Eigen::Vector3d> v);
  double go_on(Coupled coupled, double last_square, std::span<Eigen::Vector3d> v);
  double energy(Coupled coupled, std::span<const Eigen::Vector3d> v) const;
  double push(PairContact& contact, std::span<Eigen::Vector3d> v) const;
  double rub(PairContact& contact, double friction, std::span<Eigen::Vector3d> v) const;
  void add(const PairContact& contact, const Eigen::Vector3d& impulse, std::span<Eigen::Vector3d> v) const;

  std::vector<double> inverse_mass_;
  long sweeps_ = 0;
  int most_ = 0;                         // sweeps in this call
  std::vector<int> parent_, group_;      // of nodes; which group a root is
  std::vector<PairContact*> order_;      // by groups
  std::vector<int> begins_;              // of groups
  std::vector<Eigen::Vector3d> before_;  // of nodes in contact, v₀
  std::vector<Impulse> from_, way_;      // of contacts: before a sweep, and the way beyond it
};

}  // namespace springstab
