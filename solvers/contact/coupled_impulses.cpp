#include "solvers/contact/coupled_impulses.h"

#include <algorithm>
#include <cmath>

#include "solvers/contact/friction.h"

namespace springstab {
namespace {

constexpr int most_sweeps = 150;
constexpr double settled_sweep = 1e-5;  // relative, of velocities

}  // namespace

bool CoupledImpulses::solve(std::span<PairContact> contacts, double friction, std::span<Eigen::Vector3d> v) {
  double fastest = 0;
  for (PairContact& c : contacts) {
    c.r = c.mobility = 0;
    c.q.setZero();
    for (int k = 0; k < 4; ++k) {
      c.mobility += c.weights[k] * c.weights[k] * inverse_mass_[c.nodes[k]];
      before_[c.nodes[k]] = v[c.nodes[k]];
    }
    fastest = std::max({fastest, parting(c, v).norm(), c.bound});
  }
  group(contacts);
  bool settled = true;
  most_ = 0;
  for (std::size_t i = 0; i + 1 < begins_.size(); ++i)
    settled &= settle(Coupled(order_).subspan(begins_[i], begins_[i + 1] - begins_[i]), friction,
                      settled_sweep * fastest, v);
  sweeps_ += most_;
  return settled;
}

int CoupledImpulses::root(int node) {
  while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
  return node;
}

// In the order of their first contacts, each in the order of its contacts.
void CoupledImpulses::group(std::span<PairContact> contacts) {
  const auto joins = [&](const PairContact& c, int k) {
    return c.weights[k] != 0 && inverse_mass_[c.nodes[k]] > 0;
  };
  const auto first = [&](const PairContact& c) {
    int k = 0;
    while (k < 4 && !joins(c, k)) ++k;
    return k;
  };
  for (const PairContact& c : contacts)
    for (const int node : c.nodes) parent_[node] = node, group_[node] = -1;
  for (const PairContact& c : contacts)
    for (int k = first(c) + 1; k < 4; ++k)
      if (joins(c, k)) parent_[root(c.nodes[k])] = root(c.nodes[first(c)]);
  begins_.assign(2, 0);
  for (const PairContact& c : contacts) {
    if (first(c) == 4) continue;
    int& number = group_[root(c.nodes[first(c)])];
    if (number < 0) {
      number = static_cast<int>(begins_.size()) - 2;
      begins_.push_back(0);
    }
    ++begins_[number + 2];
  }
  for (std::size_t i = 2; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
  order_.resize(begins_.back());
  for (PairContact& c : contacts)
    if (first(c) < 4) order_[begins_[group_[root(c.nodes[first(c)])] + 1]++] = &c;
  begins_.pop_back();
}

bool CoupledImpulses::settle(Coupled coupled, double friction, double still, std::span<Eigen::Vector3d> v) {
  const bool settled = sweep(coupled, friction, still, true, v);
  if (energy(coupled, v) <= 0) return settled;
  for (PairContact* c : coupled) {
    c->r = 0;
    c->q.setZero();
    for (int k = 0; k < 4; ++k)
      if (c->weights[k] != 0) v[c->nodes[k]] = before_[c->nodes[k]];
  }
  return sweep(coupled, 0, still, false, v) && friction == 0;
}

// Until that settles, which it tells.
bool CoupledImpulses::sweep(Coupled coupled, double friction, double still, bool conjugate,
                            std::span<Eigen::Vector3d> v) {
  way_.assign(coupled.size(), {});
  from_.resize(coupled.size());
  double square = 0;
  for (int done = 1;; ++done) {
    double change = 0;
    most_ = std::max(most_, done);
    for (std::size_t i = 0; i < coupled.size(); ++i) {
      PairContact& c = *coupled[i];
      from_[i] = {c.r, c.q};
      change = std::max(change, push(c, v));
      if (friction > 0) change = std::max(change, rub(c, friction, v));
    }
    if (change <= still) return true;
    if (done == most_sweeps) return false;
    if (conjugate) square = go_on(coupled, square, v);
  }
}

// Beyond a sweep, along what the sweeps before it have changed, as long as they change less and less. The
// square of what this one has changed, as an energy; `last_square` is that of the last.
double CoupledImpulses::go_on(Coupled coupled, double last_square, std::span<Eigen::Vector3d> v) {
  double square = 0;
  for (std::size_t i = 0; i < coupled.size(); ++i) {
    const PairContact& c = *coupled[i];
    const double more = c.r - from_[i].r;
    square += c.mobility * (more * more + (c.q - from_[i].q).squaredNorm());
  }
  const bool grows = last_square > 0 && square >= last_square;
  const double beta = last_square > 0 && !grows ? square / last_square : 0;
  for (std::size_t i = 0; i < coupled.size(); ++i) {
    PairContact& c = *coupled[i];
    const Impulse beyond{beta * way_[i].r, beta * way_[i].q};
    way_[i] = {beyond.r + c.r - from_[i].r, beyond.q + c.q - from_[i].q};
    if (grows) way_[i] = {};
    if (beta == 0) continue;
    c.r += beyond.r;
    c.q += beyond.q;
    add(c, beyond.r * c.normal + beyond.q, v);
  }
  return square;
}

// That all impulses gave, less what those that part (b > 0) must [J].
double CoupledImpulses::energy(Coupled coupled, std::span<const Eigen::Vector3d> v) const {
  double sum = 0;
  for (const PairContact* c : coupled)
    sum += (c->r * c->normal + c->q).dot(parting(*c, before_) + parting(*c, v)) / 2 -
           c->r * std::max(c->bound, 0.);
  return sum;
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
