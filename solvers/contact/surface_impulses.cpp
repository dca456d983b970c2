#include "solvers/contact/surface_impulses.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solvers/contact/friction.h"
#include "solvers/contact/rigid_zones.h"

namespace springstab {
namespace {

constexpr int most_looks = 30;
constexpr int most_second_looks = 5;   // for second order alone
constexpr double slight = 1e-6;        // of the longest way, what is left of a gap
constexpr double second_order = 1e-4;  // of the thickness, likewise of contacts that were solved for
constexpr double parted_from = 1e-3;   // of the thickness
constexpr int most_partings = 5;
constexpr double same_place = 1e-12;  // relative

// Edges and edges have two positive weights.
bool is_before(const PairContact& a, const PairContact& b) {
  if (const auto order = a.nodes <=> b.nodes; order != 0) return order < 0;
  return (a.weights[1] > 0) < (b.weights[1] > 0);
}

bool is_same(const PairContact& a, const PairContact& b) { return !is_before(a, b) && !is_before(b, a); }

std::vector<double> inverse_masses(const std::vector<double>& mass, std::size_t nodes) {
  std::vector<double> inverse(nodes);
  std::transform(mass.begin(), mass.end(), inverse.begin(), [](double m) { return 1 / m; });
  return inverse;
}

}  // namespace

SurfaceImpulses::SurfaceImpulses(const Contact& contact, const std::vector<double>& mass,
                                 const ClothSurface& surface)
    : contact_(contact),
      lands_(std::holds_alternative<LandingImpulses>(contact.model)),
      search_(contact, static_cast<int>(mass.size()), surface),
      inverse_mass_(inverse_masses(mass, search_.nodes())),
      impulses_(inverse_mass_) {
  if (std::holds_alternative<Penalty>(contact.model))
    throw std::invalid_argument("the contact is a penalty, expected one by impulses");
  counts_.surfaces.emplace();
}

Filtered SurfaceImpulses::apply(double t, double h, const State<Vector>& before, State<Vector>& after) {
  if (!all_finite(after.x) || !all_finite(after.v)) return Filtered::unchanged;  // the watch sees it
  bool moved = false;
  if (!move_to(t, h, before, after.x, moved)) return blocked();
  if (nearest_ < -parted_from * contact_.thickness) moved |= part(t);
  const Way way = push(t, h, before, after.v);
  if (way == Way::none) return blocked();
  for (int i = 0; i < search_.free_count(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    if (moved) after.x.segment<3>(at) = x_[i];
    if (way == Way::bent) after.v.segment<3>(at) = v_[i];
  }
  reached_ = y_;
  return moved || way == Way::bent ? Filtered::changed : Filtered::unchanged;
}

Filtered SurfaceImpulses::blocked() {
  ++counts_.surfaces->blocked;
  reached_.clear();
  return Filtered::failed;
}

bool SurfaceImpulses::is_reached(const Vector& x) const {
  if (reached_.empty()) return false;
  const double rounding = same_place * x.cwiseAbs().maxCoeff();
  for (int i = 0; i < search_.free_count(); ++i)
    if (!((reached_[i] - x.segment<3>(3 * static_cast<Eigen::Index>(i))).cwiseAbs().maxCoeff() <= rounding))
      return false;
  return true;
}

// Then the way was found by the last push, but for the first step of a run.
bool SurfaceImpulses::is_as_said(double h, const State<Vector>& before, const Vector& x) const {
  return (before.x + h * before.v - x).cwiseAbs().maxCoeff() <= same_place * x.cwiseAbs().maxCoeff();
}

// Makes x_ the places at t, bent where the way there enters something. False where there is no way.
bool SurfaceImpulses::move_to(double t, double h, const State<Vector>& before, const Vector& x, bool& moved) {
  if (is_reached(x)) {
    search_.place(x, t, x_);
    return true;
  }
  search_.place(before.x, t - h, x_);
  search_.place(x, t, y_);
  v_.resize(search_.nodes());
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] = (y_[i] - x_[i]) / h;
  v_before_ = v_;
  const Way way = find_way(t - h, h, is_as_said(h, before, x) ? Unless::passing : Unless::near);
  if (way == Way::none) return false;
  if (way == Way::bent) {
    moved = true;
    for (const PairContact& c : active_) counts_.lifts += c.r > 0;
  }
  std::swap(x_, y_);
  return true;
}

// Parts what is too near at x_, to the thickness and no more, as long as that leaves more room than there
// was: between two that cannot yield there is none to gain. Whether that moved anything.
bool SurfaceImpulses::part(double t) {
  double nearest = -HUGE_VAL;
  long lifts = 0;
  int passes = 0;
  for (;; ++passes) {
    const double before = nearest;
    nearest = list_too_near(t);
    if (nearest <= before) {
      std::swap(x_, y_);
      --passes;
      break;
    }
    counts_.lifts += lifts;
    if (nearest >= -parted_from * contact_.thickness) return passes > 0;
    if (passes == most_partings) break;
    v_.assign(search_.nodes(), Eigen::Vector3d::Zero());
    impulses_.solve(active_, 0, v_);
    y_.resize(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) y_[i] = x_[i] + v_[i];
    if (search_.collide(x_, y_)) break;
    std::swap(x_, y_);
    lifts = std::count_if(active_.begin(), active_.end(), [](const PairContact& c) { return c.r > 0; });
  }
  ++counts_.unresolved;
  return passes > 0;
}

// Makes what is too near at x_ active; by how much the nearest lacks the thickness, negative.
double SurfaceImpulses::list_too_near(double t) {
  double nearest = 0;
  active_.clear();
  for (const Entered& e : search_.too_near(x_, t)) {
    active_.push_back(e.contact);
    nearest = std::min(nearest, e.gap);
  }
  return nearest;
}

// Makes v_ the velocity from x_ that enters nothing.
SurfaceImpulses::Way SurfaceImpulses::push(double t, double h, const State<Vector>& before, const Vector& v) {
  search_.set_velocities(before.v, v_before_);
  search_.set_velocities(v, v_);
  search_.advance(x_, v_, h, t + h, y_);
  const long sweeps = impulses_.sweeps(), found = search_.found();
  const Way way = find_way(t, h, Unless::near);
  counts_.passes += impulses_.sweeps() - sweeps;
  counts_.pairs += search_.found() - found;
  if (way == Way::bent) counts_.largest_rise = std::max(counts_.largest_rise, count_work());
  return way;
}

// From x_, at t, with the velocity v_ that is wanted, to y_; changes v_ and y_ where that enters something.
SurfaceImpulses::Way SurfaceImpulses::find_way(double t, double h, Unless unless) {
  active_.clear();
  bool has_settled = true, bent = false;
  for (int pass = 0; pass < most_looks; ++pass) {
    entered_ = search_.entered(x_, y_, t, h, lands_);
    nearest_ = 0;
    bool passes = false;
    for (const Entered& e : entered_) {
      nearest_ = std::min(nearest_, e.gap);
      passes |= e.passes;
    }
    const bool is_done = unless == Unless::passing && !bent && !passes;
    if (is_done || !take_over(h, pass)) {
      if (passes) break;
      if (!has_settled) ++counts_.unresolved;
      return bent ? Way::bent : Way::as_wanted;
    }
    if (!bent) wanted_ = v_;
    bent = true;
    v_ = wanted_;
    has_settled = impulses_.solve(active_, contact_.friction, v_);
    search_.advance(x_, v_, h, t + h, y_);
  }
  return move_as_one(t, h) ? Way::bent : Way::none;
}

// Makes what was entered active. False where that asks for no other velocity.
bool SurfaceImpulses::take_over(double h, int pass) {
  double longest = 0;
  for (int i = 0; i < search_.free_count(); ++i) longest = std::max(longest, (y_[i] - x_[i]).squaredNorm());
  const double most_new = slight * std::sqrt(longest) / h,
               most_active = std::max(most_new, second_order * contact_.thickness / h);
  bool asks = false;
  fresh_.clear();
  for (const Entered& e : entered_) {
    PairContact c = e.contact;
    c.slip_before = tangential(parting(c, v_before_), c.normal);
    const auto place = std::lower_bound(active_.begin(), active_.end(), c, is_before);
    const bool is_active = place != active_.end() && is_same(*place, c);
    const double lacks = c.bound - c.normal.dot(parting(c, v_));
    if (is_active) {
      asks |= lacks > most_active && (e.passes || pass < most_second_looks);
    } else if (lacks > most_new) {
      asks = true;
      fresh_.push_back(c);
    }
  }
  if (!asks) return false;
  for (const Entered& e : entered_) {
    const auto place = std::lower_bound(active_.begin(), active_.end(), e.contact, is_before);
    if (place == active_.end() || !is_same(*place, e.contact)) continue;
    *place = e.contact;
    place->slip_before = tangential(parting(*place, v_before_), place->normal);
  }
  active_.insert(active_.end(), fresh_.begin(), fresh_.end());
  std::stable_sort(active_.begin(), active_.end(), is_before);
  active_.erase(std::unique(active_.begin(), active_.end(), is_same), active_.end());
  return true;
}

bool SurfaceImpulses::move_as_one(double t, double h) {
  active_.clear();
  RigidZones zones(inverse_mass_);
  for (bool joined = true; joined;) {
    joined = false;
    nearest_ = 0;
    for (const Entered& e : search_.entered(x_, y_, t, h, lands_)) {
      nearest_ = std::min(nearest_, e.gap);
      if (e.passes) joined |= zones.join(e.contact.nodes);
    }
    if (!zones.apply(v_)) return false;
    search_.advance(x_, v_, h, t + h, y_);
  }
  counts_.surfaces->zones += zones.count();
  return true;
}

// What contact has done to E in this step.
double SurfaceImpulses::count_work() {
  double rise = 0;
  for (const PairContact& c : active_) {
    if (c.r == 0) continue;
    const Eigen::Vector3d impulse = c.r * c.normal + c.q, mean = (parting(c, v_before_) + parting(c, v_)) / 2;
    const double normal = c.r * c.normal.dot(mean), friction = c.q.dot(mean);
    for (int k = 0; k < 4; ++k)
      if (inverse_mass_[c.nodes[k]] == 0) counts_.obstacle_work -= c.weights[k] * impulse.dot(v_[c.nodes[k]]);
    ++counts_.impulses;
    counts_.normal_work += normal;
    counts_.friction_work += friction;
    rise += normal + friction;
  }
  return rise;
}

}  // namespace springstab
