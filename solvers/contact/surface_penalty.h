// Contact of a cloth's surface with itself and with meshes at rest by springs and dampers, wherever two
// places are nearer than the thickness (touch.h, surface_touches.h): they enter forces, K and C with exact
// derivatives, and couple whatever is near. With n and the weights w held, a contact adds k_c (w wᵀ) ⊗ (n nᵀ)
// to K, and w wᵀ ⪯ diag(|w_i| Σ|w|): with at most c contacts at a particle, each counted by its |w_i|,
//     K_contact ⪯ K + 2 c k_c,   D_contact ⪯ D + 2 c d_c + 2 α c k_c,
// and half of that where one side does not move. What turning normals and moving weights add to the exact K,
// -k_c (t - d) ∇²d, has no such bound.
#pragma once

#include <memory>

#include "solvers/contact/contact_filter.h"
#include "solvers/contact/surface_touches.h"
#include "solvers/scene/terms.h"

namespace springstab {

/// For Scene::add: numbers of particles as the scene has them. Throws std::invalid_argument where the contact
/// is no penalty.
TermMaker surface_penalty_terms(const Contact& contact, std::shared_ptr<SurfaceTouches> touches);

/// Between steps: counts the contacts at a particle, and has a step taken back that has more of them than
/// what it was planned for (ContactFilter::plan_for). Friction is an impulse of at most μ h k_c (t - d) a
/// contact, which keeps momentum.
class SurfacePenaltyFilter final : public ContactFilter {
 public:
  /// One mass for each free particle [kg].
  SurfacePenaltyFilter(const Contact& contact, std::vector<double> mass,
                       std::shared_ptr<SurfaceTouches> touches);
  Filtered apply(double t, double h, const State<Vector>& before, State<Vector>& after) override;

 private:
  bool rub(const Touch& touch, double h, const State<Vector>& before, State<Vector>& after);

  std::unique_ptr<ContactFilter> of_obstacles_;  // planes and balls; null where they have no friction
  double friction_, stiffness_;
  std::vector<double> mass_;
  std::shared_ptr<SurfaceTouches> touches_;
};

/// The contacts at a particle that a step is to be planned for: the most there are, in whole numbers, and at
/// least 1.
long whole_contacts(double most);

}  // namespace springstab
