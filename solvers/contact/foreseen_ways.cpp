#include "solvers/contact/foreseen_ways.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace springstab {
namespace {

constexpr double most_steps = 64;
constexpr double furthest_own_half_way = 4;  // tolerances; of a step at least
constexpr double still_inside = 1 - 1e-6;    // of the tolerance's square: rounding is far less
constexpr std::size_t most_strays = 16;
constexpr double least_advance = 0.5;  // steps that a step counts for

}  // namespace

ForeseenWays::ForeseenWays(std::vector<int> particles, int count, double tolerance)
    : particles_(std::move(particles)),
      tolerance_(tolerance),
      start_(count, Eigen::Vector3d::Zero()),
      half_way_(count, Eigen::Vector3d::Zero()) {
  strays_.reserve(most_strays);
}

// That at which all together are nearest to where they were to be, in halves of what is foreseen.
double ForeseenWays::time(PlaceList x) const {
  double along = 0;
  for (const int i : particles_) along += half_way_[i].dot(x[i] - start_[i]);
  return square_ > 0 ? std::clamp(along / square_, 0., 2.) : 0;
}

bool ForeseenWays::is_there(int i, const Eigen::Vector3d& x, double t) const {
  return (x - start_[i] - t * half_way_[i]).squaredNorm() <= still_inside * tolerance_ * tolerance_;
}

bool ForeseenWays::hold(PlaceList x) const {
  if (!has_ways_) return false;
  const double t = time(x);
  return std::all_of(particles_.begin(), particles_.end(), [&](int i) { return is_there(i, x[i], t); });
}

void ForeseenWays::set_way(int i, const Eigen::Vector3d& half_way) {
  square_ += half_way.squaredNorm() - half_way_[i].squaredNorm();
  half_way_[i] = half_way;
}

void ForeseenWays::foresee(PlaceList x0, PlaceList x1) {
  has_ways_ = false;
  const bool is_step = x0.data() != x1.data();
  const double halves = steps_ / 2;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int i : particles_) {
    if (!x0[i].allFinite() || !x1[i].allFinite())
      throw std::invalid_argument("the place of particle " + std::to_string(i) +
                                  " is not finite, expected it so");
    start_[i] = x0[i];
    half_way_[i] = is_step ? Eigen::Vector3d(x1[i] - x0[i]) : Eigen::Vector3d(half_way_[i] / halves);
    mean += half_way_[i] / static_cast<double>(particles_.size());
  }
  double furthest = 0;
  for (const int i : particles_) furthest = std::max(furthest, (half_way_[i] - mean).norm());
  steps_ = std::clamp(2 * furthest_own_half_way * tolerance_ / furthest, 1., most_steps);
  square_ = 0;
  mean_half_way_ = steps_ / 2 * mean;
  for (const int i : particles_) {
    half_way_[i] *= steps_ / 2;
    square_ += half_way_[i].squaredNorm();
  }
  has_ways_ = true;
}

bool ForeseenWays::follow(PlaceList x0, PlaceList x1) {
  if (!has_ways_) return false;
  const bool is_step = x0.data() != x1.data();
  const double t0 = time(x0), t1 = time(x1);
  if (is_step && !((t1 - t0) * steps_ / 2 > least_advance)) return false;
  strays_.clear();
  for (const int i : particles_) {
    if (is_there(i, x0[i], t0) && is_there(i, x1[i], t1)) continue;
    if (strays_.size() == most_strays) return false;
    strays_.push_back(i);
  }
  for (const int i : strays_) {
    if (is_step) set_way(i, (x1[i] - x0[i]) / (t1 - t0));
    if (!(own_half_way(i).norm() <= 2 * furthest_own_half_way * tolerance_)) return false;
    start_[i] = x0[i] - t0 * half_way_[i];
  }
  return hold(x0) && (!is_step || hold(x1));
}

}  // namespace springstab
