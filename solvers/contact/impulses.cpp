#include "solvers/contact/impulses.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "solvers/contact/friction.h"

namespace springstab {
namespace {

constexpr int most_passes = 100;
constexpr double settled = 1e-14;   // relative, of places
constexpr double resolved = 1e-12;  // likewise of velocities

}  // namespace

Impulses::Impulses(const Contact& contact, std::vector<double> mass)
    : contact_(contact),
      mass_(std::move(mass)),
      lands_(std::holds_alternative<LandingImpulses>(contact.model)),
      reach_(contact.thickness),
      touches_(contact.obstacles.size()),
      order_(contact.obstacles.size()) {
  spaces_.reserve(touches_.size());
  if (std::holds_alternative<Penalty>(contact.model))
    throw std::invalid_argument("the contact is a penalty, expected one by impulses");
  for (const Obstacle& obstacle : contact_.obstacles) reach_ = std::max(reach_, extent_of(obstacle));
}

Filtered Impulses::apply(double t, double h, const State<Vector>& before, State<Vector>& after) {
  bool changed = false;
  double rise = 0;
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    Motion p{mass_[i],
             t,
             h,
             before.x.segment<3>(at),
             before.v.segment<3>(at),
             after.x.segment<3>(at),
             after.v.segment<3>(at)};
    if (is_clear(p)) continue;
    const bool lifted = lift(p), pushed = push(p);
    if (pushed) rise += count_work(p);
    if (!lifted && !pushed) continue;
    changed = true;
    after.x.segment<3>(at) = p.x;
    after.v.segment<3>(at) = p.v;
  }
  counts_.largest_rise = std::max(counts_.largest_rise, rise);
  return changed ? Filtered::changed : Filtered::unchanged;
}

Gap Impulses::gap(std::size_t obstacle, const Eigen::Vector3d& x, double t) const {
  Gap at = gap_at(contact_.obstacles[obstacle], x, t);
  at.gap -= contact_.thickness;
  return at;
}

// Most particles are, so that this is what contact costs them.
bool Impulses::is_clear(const Motion& p) {
  counts_.pairs += static_cast<long>(touches_.size());
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    const Gap at = gap(k, p.x, p.t);
    if (at.gap < 0 || at.gap + p.h * at.normal.dot(p.v - contact_.obstacles[k].velocity) < 0) return false;
  }
  return true;
}

// Onto one surface after the other, until all of them are clear. Of a way along it that accelerations within
// the step have added, friction takes back as much as Coulomb's law lets it for the depth.
bool Impulses::lift(Motion& p) {
  const double rounding = settled * (p.x.norm() + reach_);
  double deepest = rounding;
  bool moved = false;
  for (int pass = 0; pass < most_passes && deepest >= rounding; ++pass) {
    deepest = 0;
    for (std::size_t k = 0; k < touches_.size(); ++k) {
      const Gap at = gap(k, p.x, p.t);
      if (at.gap >= 0) continue;
      p.x -= at.gap * at.normal;
      const Eigen::Vector3d way =
          tangential(p.x - p.x_before - p.h * contact_.obstacles[k].velocity, at.normal);
      const double back = std::min(-contact_.friction * at.gap, way.norm());
      if (back > 0) p.x -= back * way.normalized();
      moved = true;
      deepest = std::max(deepest, -at.gap);
    }
    if (pass == 0 && deepest > rounding) ++counts_.lifts;
    if (touches_.size() == 1) return moved;
  }
  if (deepest > rounding) ++counts_.unresolved;
  return moved;
}

// The velocity that lands is the negative of gap/h; a place inside, which lift() has left there, does not
// throw.
double Impulses::landing_speed(std::size_t obstacle, double h) const {
  return -std::max(touches_[obstacle].at.gap, 0.) / h;
}

bool Impulses::would_enter(std::size_t obstacle, const Motion& p) const {
  const Obstacle& other = contact_.obstacles[obstacle];
  const Eigen::Vector3d relative = p.v - other.velocity;
  return touches_[obstacle].at.normal.dot(relative) < landing_speed(obstacle, p.h) &&
         path_enters(other, p.t, p.x, p.h * relative, contact_.thickness);
}

bool Impulses::push(Motion& p) {
  spaces_.clear();
  double fastest = p.v.norm();
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    touches_[k] = {gap(k, p.x, p.t), false, 0, Eigen::Vector3d::Zero()};
    fastest = std::max(fastest, contact_.obstacles[k].velocity.norm());
  }
  if (!add_entered(p)) return false;
  const double rounding = resolved * fastest;
  const Eigen::Vector3d free = p.v;
  for (int pass = 0; pass < most_passes; ++pass) {
    ++counts_.passes;
    p.v = free;
    for (const Touch& touch : touches_) p.v += touch.q / p.mass;
    if (!push_off(p, rounding)) break;
    if (rub(p) <= rounding) return true;
  }
  // Without friction energy falls all the same.
  ++counts_.unresolved;
  for (Touch& touch : touches_) touch.q.setZero();
  p.v = free;
  push_off(p, rounding);
  return true;
}

// Gives those a half-space of velocities that the step to come would enter. Whether there is a new one.
bool Impulses::add_entered(const Motion& p) {
  bool any = false;
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    if (touches_[k].touches || !would_enter(k, p)) continue;
    const Eigen::Vector3d& n = touches_[k].at.normal;
    spaces_.push_back({n, n.dot(contact_.obstacles[k].velocity) + (lands_ ? landing_speed(k, p.h) : 0)});
    order_[spaces_.size() - 1] = k;
    any = touches_[k].touches = true;
  }
  return any;
}

// To the nearest velocity from which nothing is entered. False where there is none; then the velocity stays.
bool Impulses::push_off(Motion& p, double rounding) {
  for (Touch& touch : touches_) touch.r = 0;
  const Eigen::Vector3d from = p.v;
  do {
    p.v = from;
    if (!project(spaces_, rounding, p.v)) return p.v = from, false;
  } while (add_entered(p));
  for (std::size_t i = 0; i < spaces_.size(); ++i) touches_[order_[i]].r = p.mass * spaces_[i].multiplier;
  return true;
}

// Friction, one obstacle after the other. How much it has changed the velocity [m/s].
double Impulses::rub(Motion& p) {
  double change = 0;
  if (contact_.friction == 0) return change;
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    Touch& touch = touches_[k];
    const Eigen::Vector3d &n = touch.at.normal, &u = contact_.obstacles[k].velocity;
    const Eigen::Vector3d slip = tangential(p.v - touch.q / p.mass - u, n);
    const Eigen::Vector3d q =
        friction_impulse(contact_.friction * touch.r, p.mass, tangential(p.v_before - u, n), slip);
    p.v += (q - touch.q) / p.mass;
    change = std::max(change, (q - touch.q).norm() / p.mass);
    touch.q = q;
  }
  return change;
}

// What contact has done to E by this particle.
double Impulses::count_work(const Motion& p) {
  double work = 0;
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    const Touch& touch = touches_[k];
    if (touch.r == 0) continue;
    const Eigen::Vector3d& u = contact_.obstacles[k].velocity;
    const double from = gap(k, p.x_before, p.t - p.h).gap, to = gap(k, p.x + p.h * p.v, p.t + p.h).gap;
    const double normal = touch.r * (to - from) / (2 * p.h);
    const double friction = touch.q.dot((p.v + p.v_before) / 2 - u);
    ++counts_.impulses;
    counts_.normal_work += normal;
    counts_.friction_work += friction;
    counts_.obstacle_work += (touch.r * touch.at.normal + touch.q).dot(u);
    work += normal + friction;
  }
  return work;
}

}  // namespace springstab
