// Contact of a cloth's surface with itself and with meshes (and of its particles with planes and balls) by
// impulses behind any method's step. A step that did not end where its velocity led (impulses.h: symplectic
// Euler's does) is bent so that nothing passes through anything and nothing is nearer than the thickness;
// what is nearer than it by second order, as where faces turn, is parted to it; then impulses change the
// velocity so that the step to come does the same. All three are the nearest way in the mass norm to the one
// wanted,
//     x⁺ = x + hv,   gap(x⁺) >= 0 by gap(y) + n·Σ w (x⁺ - y) >= 0 at the last y found (or at the time of
//     impact),
// solved again, with all contacts found so far, until nothing new is (coupled_impulses.h). What that does not
// part moves as one (rigid_zones.h), so that no step ends in an intersection; and where even that cannot be,
// as between obstacles that close in, the step has failed.
#pragma once

#include <vector>

#include "solvers/contact/contact_filter.h"
#include "solvers/contact/contact_search.h"
#include "solvers/contact/coupled_impulses.h"

namespace springstab {

class SurfaceImpulses final : public ContactFilter {
 public:
  /// One mass for each free particle [kg]. Throws std::invalid_argument where the model is a penalty; and see
  /// ContactSearch.
  SurfaceImpulses(const Contact& contact, const std::vector<double>& mass, const ClothSurface& surface);

  Filtered apply(double t, double h, const State<Vector>& before, State<Vector>& after) override;

 private:
  enum class Way { as_wanted, bent, none };
  /// What a way is left as it is for.
  enum class Unless { passing, near };

  Filtered blocked();
  bool is_reached(const Vector& x) const;
  bool is_as_said(double h, const State<Vector>& before, const Vector& x) const;
  bool move_to(double t, double h, const State<Vector>& before, const Vector& x, bool& moved);
  bool part(double t);
  double list_too_near(double t);
  Way push(double t, double h, const State<Vector>& before, const Vector& v);
  Way find_way(double t, double h, Unless unless);
  bool take_over(double h, int pass);
  bool move_as_one(double t, double h);
  double count_work();

  Contact contact_;
  bool lands_;
  ContactSearch search_;
  std::vector<double> inverse_mass_;
  CoupledImpulses impulses_;
  Places x_, y_, v_, wanted_, v_before_;
  std::vector<PairContact> active_;  // by their nodes
  std::vector<PairContact> fresh_;
  std::span<const Entered> entered_;  // by the step from x to y
  double nearest_ = 0;                // their least gap [m]
  Places reached_;                    // where the last velocity leads, and nearest_ is known
};

}  // namespace springstab
