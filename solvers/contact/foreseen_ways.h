// Where particles will be for some steps to come: on their ways, s + τ w with one τ for all, 0 <= τ <=
// `steps`, each to within a tolerance. As long as they are, what may come within reach of what does not
// change. Ways are those of a step, so that a cloth that falls has not gone anywhere; those that leave them,
// as what has hit something does, get new ones.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace springstab {

class ForeseenWays {
 public:
  /// Of these particles, whose numbers are below `count`; the tolerance is positive [m].
  ForeseenWays(std::vector<int> particles, int count, double tolerance);

  using PlaceList = std::span<const Eigen::Vector3d>;
  /// Whether all places are as foreseen, at one time.
  bool hold(PlaceList x) const;
  /// Anew, as from x0 to x1; as before where these are the same list. Throws std::invalid_argument where a
  /// place is not finite.
  void foresee(PlaceList x0, PlaceList x1);
  /// Gives those that are not where they were to be at x0 or x1 new ways from there, so that both hold. False
  /// where there are too many, or that is not enough: nothing can be said of the ways then.
  bool follow(PlaceList x0, PlaceList x1);
  const std::vector<int>& strays() const { return strays_; }  // of the last call of follow

  /// Half of all that is foreseen, and where a particle is then [m].
  const Eigen::Vector3d& half_way(int i) const { return half_way_[i]; }
  Eigen::Vector3d middle(int i) const { return start_[i] + half_way_[i]; }
  /// Half of the way beside the mean of all: those who go together have none.
  Eigen::Vector3d own_half_way(int i) const { return half_way_[i] - mean_half_way_; }

 private:
  double time(PlaceList x) const;
  bool is_there(int i, const Eigen::Vector3d& x, double t) const;
  void set_way(int i, const Eigen::Vector3d& half_way);

  std::vector<int> particles_, strays_;
  double tolerance_;
  bool has_ways_ = false;
  double steps_ = 1;
  std::vector<Eigen::Vector3d> start_, half_way_;
  Eigen::Vector3d mean_half_way_{0, 0, 0};
  double square_ = 0;  // of all half ways together
};

}  // namespace springstab
