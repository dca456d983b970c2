// Convex polygons inside a method's closed stable region: what the joint numerical range of a damped system
// must fit into for a certificate. Derived from the region's exact boundary, for any method.
#pragma once

#include <vector>

#include "analysis/regions/stability_region.h"
#include "analysis/spectra/numerical_range.h"

namespace springstab {

/// K -> F K and D -> D + β K: with a safety factor F the damping stays, β = 0, or α does, β = (F - 1) α.
struct Stiffening {
  double factor = 1;         // F
  double added_damping = 0;  // β [s]

  ModePoint operator()(const ModePoint& p) const { return {p.d + added_damping * p.k, factor * p.k}; }
};

/// The step h > 0 [s] at which (h d, h² k), d and k >= 0, leaves the half-plane, whose bound is not negative:
/// 0 where it does so at once, ∞ where it never does.
double exit_step(const HalfPlane& half_plane, const ModePoint& p);

/// A polygon, as its half-planes beside X >= 0 and Y >= 0, and the step up to which some modes fit into it.
struct PolygonFit {
  double h = 0;  // [s]
  std::vector<HalfPlane> edges;
};

/// The polygons of one method. A region that is not convex has several largest convex parts: each is cut off
/// along one tangent of a reflex arc of the boundary.
class InscribedPolygons {
 public:
  explicit InscribedPolygons(const StabilityRegion& region);

  /// The polygon that lets these modes have the largest h, to about 1e-4 of it and with few edges; no edges
  /// where no part of the region touches the origin. A mode is stable in it, but for rounding: its edges keep
  /// 1e-9 of their distance from the origin away from the boundary, and so from unimodular double roots.
  PolygonFit fit(const std::vector<ModePoint>& modes) const;

 private:
  struct Vertex {
    double x, y;
  };
  using Chain = std::vector<Vertex>;  // clockwise from the origin to the X axis

  static Chain boundary_chain(const StabilityRegion& region);
  static std::vector<std::size_t> reflex(const Chain& chain);
  static Chain cut(const Chain& chain, std::size_t at);
  static bool is_inside(const StabilityRegion& region, const Chain& chain);
  static HalfPlane edge(const Vertex& p, const Vertex& q);
  static PolygonFit fit(const Chain& chain, const std::vector<ModePoint>& modes);

  std::vector<Chain> convex_parts_;
};

/// Those of that method, computed once (see stability_region).
const InscribedPolygons& inscribed_polygons(const Method& method);

}  // namespace springstab
