#include "solvers/contact/coupled_impulses.h"

#include <algorithm>
#include <cmath>

#include "solvers/contact/friction.h"

namespace springstab {
namespace {

constexpr int most_sweeps = 60;
constexpr double settled_sweep = 1e-5;  // relative, of velocities

}  // namespace

bool CoupledImpulses::solve(std::span<PairContact> contacts, double friction, std::span<Eigen::Vector3d> v) {
  double fastest = 0;
  for (PairContact& c : contacts) {
    c.r = c.mobility = 0;
    c.q.setZero();
    for (int k = 0; k < 4; ++k) c.mobility += c.weights[k] * c.weights[k] * inverse_mass_[c.nodes[k]];
    fastest = std::max(fastest, parting(c, v).squaredNorm());
  }
  const double still = settled_sweep * std::sqrt(fastest);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0;
    ++sweeps_;
    for (PairContact& c : contacts) {
      change = std::max(change, push(c, v));
      if (friction > 0) change = std::max(change, rub(c, friction, v));
    }
    if (change <= still) return true;
  }
  return false;
}

// Both say how much faster the places part for it [m/s].
double CoupledImpulses::push(PairContact& c, std::span<Eigen::Vector3d> v) const {
  const double lacks = c.bound - c.normal.dot(parting(c, v));
  const double more = std::max(-c.r, lacks / c.mobility);
  if (more == 0) return 0;
  c.r += more;
  add(c, more * c.normal, v);
  return std::abs(more) * c.mobility;
}

double CoupledImpulses::rub(PairContact& c, double friction, std::span<Eigen::Vector3d> v) const {
  if (c.r == 0 && c.q.isZero(0)) return 0;
  const Eigen::Vector3d slip = tangential(parting(c, v) - c.mobility * c.q, c.normal);
  const Eigen::Vector3d q = friction_impulse(friction * c.r, 1 / c.mobility, c.slip_before, slip),
                        more = q - c.q;
  c.q = q;
  add(c, more, v);
  return more.norm() * c.mobility;
}

void CoupledImpulses::add(const PairContact& c, const Eigen::Vector3d& impulse,
                          std::span<Eigen::Vector3d> v) const {
  for (int k = 0; k < 4; ++k)
    if (c.weights[k] != 0) v[c.nodes[k]] += c.weights[k] * inverse_mass_[c.nodes[k]] * impulse;
}

}  // namespace springstab
