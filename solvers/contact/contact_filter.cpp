#include "solvers/contact/contact_filter.h"

#include <algorithm>
#include <cmath>

#include "solvers/contact/impulses.h"
#include "solvers/contact/penalty.h"
#include "solvers/contact/surface_impulses.h"
#include "solvers/contact/surface_penalty.h"

namespace springstab {

std::unique_ptr<ContactFilter> make_contact_filter(const Contact& contact, const std::vector<double>& mass,
                                                   const ClothSurface& surface) {
  const bool springs = std::holds_alternative<Penalty>(contact.model);
  if (contact.has_surfaces() && springs)
    return std::make_unique<SurfacePenaltyFilter>(
        contact, mass, std::make_shared<SurfaceTouches>(contact, static_cast<int>(mass.size()), surface));
  if (contact.has_surfaces()) return std::make_unique<SurfaceImpulses>(contact, mass, surface);
  if (!springs) return std::make_unique<Impulses>(contact, mass);
  if (contact.friction == 0) return nullptr;
  return std::make_unique<PenaltyFriction>(contact, mass);
}

EnergyWatch with_obstacles(EnergyWatch watch, const Contact& contact) {
  double fastest = 0;
  for (const Obstacle& obstacle : contact.obstacles) fastest = std::max(fastest, obstacle.velocity.norm());
  for (const MeshObstacle& mesh : contact.meshes) fastest = std::max(fastest, mesh.velocity.norm());
  const double root = std::sqrt(std::max(watch.initial_energy, 0.)) + 2 * fastest * std::sqrt(watch.mass / 2);
  if (fastest > 0) watch.initial_energy = root * root;
  return watch;
}

}  // namespace springstab
