// Contact with obstacles by impulses behind any method's step. A particle that the step has taken into an
// obstacle is put back on its surface, and along it against its way by at most μ times the depth, as far as
// it came; then impulses r >= 0 along the normals n change the velocity so that the step to come, x + hv,
// enters no obstacle:
//     v ← v + (Σ r n + q)/m,   0 <= r ⟂ gap(x) + h n·(v - u) >= 0,   q: friction.h, u: the obstacle's
//     velocity,
// in the mass norm, a quadratic program a particle (half_spaces.h), with friction by fixed point. Such
// velocities are a convex set that holds u, so that the kinetic energy relative to u does not grow by it.
// (InelasticImpulses: n·(v - u) = 0 instead, as soon as the step to come would enter.)
//
// Symplectic Euler goes where its velocity said, x⁺ = x + hv, so that nothing has to be put back. With flat
// obstacles at rest the energy that belongs to it,
//     E = ½vᵀ(M - hD/2 - h²K/4)v + ½x̄ᵀKx̄ - fᵀx̄,   x̄ the mean of two neighbouring positions,
// changes by the impulses by r (gap⁺ - gap₋)/(2h), gap₋ where the step began and gap⁺ = 0 where the next one
// ends: it never grows, at any step for which it is bounded below, 4M ≻ 2hD + h²K. (Paoli and Schatzman
// 2002.)
#pragma once

#include <vector>

#include "solvers/contact/contact_filter.h"
#include "solvers/contact/half_spaces.h"

namespace springstab {

class Impulses final : public ContactFilter {
 public:
  /// Of a state with three entries a particle; one mass each [kg]. Throws std::invalid_argument where the
  /// model is a penalty.
  Impulses(const Contact& contact, std::vector<double> mass);

  Filtered apply(double t, double h, const State<Vector>& before, State<Vector>& after) override;

 private:
  /// A particle's step, as it is and as it was.
  struct Motion {
    double mass, t, h;
    Eigen::Vector3d x_before, v_before, x, v;
  };
  /// Of the particle with one obstacle.
  struct Touch {
    Gap at;  // beyond the thickness
    bool touches;
    double r;
    Eigen::Vector3d q;
  };

  Gap gap(std::size_t obstacle, const Eigen::Vector3d& x, double t) const;
  bool is_clear(const Motion& p);
  bool lift(Motion& p);
  bool push(Motion& p);
  double landing_speed(std::size_t obstacle, double h) const;
  bool would_enter(std::size_t obstacle, const Motion& p) const;
  bool add_entered(const Motion& p);
  bool push_off(Motion& p, double rounding);
  double rub(Motion& p);
  double count_work(const Motion& p);

  Contact contact_;
  std::vector<double> mass_;
  bool lands_;
  double reach_;                    // of the obstacles, for the rounding of places [m]
  std::vector<Touch> touches_;      // one for each obstacle
  std::vector<HalfSpace> spaces_;   // of velocities, of those that touch
  std::vector<std::size_t> order_;  // whose they are
};

}  // namespace springstab
