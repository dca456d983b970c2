// The part of contact that acts between a method's steps, and what it counts.
#pragma once

#include <functional>
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

/// Of springs between surfaces (surface_penalty.h).
struct SpringCounts {
  long contacts = 1;  // at a particle: the most there were, in whole numbers
  long plans = 0;     // times that steps were planned anew for more of them
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
  std::optional<SurfaceCounts> surfaces{};    // where there are any, by impulses
  std::optional<SpringCounts> springs{};      // or by springs
};

/// A filter that says what contact has cost.
class ContactFilter : public StepFilter {
 public:
  const ContactCounts& counts() const { return counts_; }
  /// Goes on counting from there.
  void set_counts(const ContactCounts& counts) { counts_ = counts; }

  /// Asked where there are more contacts at a particle than ever before, by springs between surfaces: where
  /// the answer is no, the step is taken back for another plan (Filtered::outgrown).
  using IsPlannedFor = std::function<bool(long contacts)>;
  void plan_for(IsPlannedFor is_planned_for) { is_planned_for_ = std::move(is_planned_for); }

 protected:
  ContactCounts counts_;
  IsPlannedFor is_planned_for_;
};

/// For states of three entries a particle, with one mass each [kg]. Null where nothing is to be done between
/// steps: of a penalty without friction. The surface is for contact that has surfaces.
std::unique_ptr<ContactFilter> make_contact_filter(const Contact& contact, const std::vector<double>& mass,
                                                   const ClothSurface& surface = {});

/// Allows for the motion that obstacles give: with u the fastest, twice the speed u of all that moves.
EnergyWatch with_obstacles(EnergyWatch watch, const Contact& contact);

}  // namespace springstab
