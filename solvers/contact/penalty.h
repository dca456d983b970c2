// Contact with obstacles at rest by springs and dampers, where a particle is inside (gap < 0):
//     E = ½ k_c gap²,   K = k_c (n nᵀ + gap κ (I - n nᵀ)) ⪯ k_c n nᵀ,   C = d_c n nᵀ,
// so that a particle in contact with c obstacles has at most c k_c and c d_c added to its K and D, in every
// state.
#pragma once

#include "solvers/contact/contact_filter.h"
#include "solvers/scene/terms.h"

namespace springstab {

/// Throws std::invalid_argument where the contact is by impulses.
const Penalty& penalty_of(const Contact& contact);

/// For Scene::add, of planes and balls. Throws std::invalid_argument where the contact is no penalty or an
/// obstacle moves: a scene's forces do not know the time.
TermMaker penalty_terms(const Contact& contact);

/// Friction between steps: an impulse of at most μ h k_c |gap| (friction.h) against the slip.
class PenaltyFriction final : public ContactFilter {
 public:
  PenaltyFriction(const Contact& contact, std::vector<double> mass);
  Filtered apply(double t, double h, const State<Vector>& before, State<Vector>& after) override;

 private:
  Contact contact_;
  double stiffness_;
  std::vector<double> mass_;
};

}  // namespace springstab
