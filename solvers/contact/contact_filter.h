// The part of contact that acts between a method's steps, and what it counts.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "solvers/contact/contact.h"
#include "solvers/simulation.h"

namespace springstab {

/// The same of surfaces alone.
struct SurfaceCounts {
  long zones = 0;    // of particles that had to move as one, in a step
  long blocked = 0;  // steps that had no way
};

/// What contact has done in a run, steps that were undone included.
struct ContactCounts {
  long pairs = 0;       // of particle and obstacle, that were tested; of surfaces: that were too near
  long impulses = 0;    // on a particle by an obstacle in a step
  long lifts = 0;       // particles put back on the surface, beyond rounding
  long passes = 0;      // solutions for a particle's velocity
  long unresolved = 0;  // particles left no room, or whose friction did not settle, in a step
  double normal_work = 0, friction_work = 0;  // on E, relative to the obstacles [J]
  double obstacle_work = 0;                   // of obstacles in motion on the particles [J]
  double largest_rise = 0;                    // of E by contact in one step [J]
  std::optional<SurfaceCounts> surfaces{};    // where there are any
};

/// A filter that says what contact has cost.
class ContactFilter : public StepFilter {
 public:
  const ContactCounts& counts() const { return counts_; }
  /// Goes on counting from there.
  void set_counts(const ContactCounts& counts) { counts_ = counts; }

 protected:
  ContactCounts counts_;
};

/// For states of three entries a particle, with one mass each [kg]. Null where nothing is to be done between
/// steps: of a penalty without friction. The surface is for contact that has surfaces.
std::unique_ptr<ContactFilter> make_contact_filter(const Contact& contact, const std::vector<double>& mass,
                                                   const ClothSurface& surface = {});

/// Allows for the motion that obstacles give: with u the fastest, twice the speed u of all that moves.
EnergyWatch with_obstacles(EnergyWatch watch, const Contact& contact);

}  // namespace springstab
