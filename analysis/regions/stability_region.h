// The stable region of a method in the X-Y plane, X = hd and Y = h²k, and its exact boundary.
//
// A 2x2 matrix with trace T and determinant Δ has both eigenvalues inside the unit disk iff Jury's three
// inequalities hold (Jury 1964; for real coefficients):
//     1 - Δ > 0   (equality: a complex pair on the unit circle, or λ₁λ₂ = 1),
//     1 - T + Δ > 0   (equality: λ = 1),
//     1 + T + Δ > 0   (equality: λ = -1).
// T and Δ are the rational functions that the method's own step gives. Along any polynomial curve
// (X(t), Y(t)) the three are rational in t, so where they change sign is a polynomial root problem:
// columns, damping lines and the path of one mode as h grows are all such curves. No raster is involved.
//
//     const StabilityRegion& region = stability_region("rk4");
//     const double reach = region.constants().imaginary_interval;  // 2 √2: undamped modes up to ωh
//     const double h = region.critical_step(1e4, 2);               // of k = 1e4 1/s², d = 2 1/s [s]
//     const auto arcs = region.boundary(region.natural_window(0.1));
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/method.h"
#include "analysis/regions/polynomial.h"

namespace springstab {

/// What ends a stable interval: one of Jury's conditions, or the window that was asked for.
enum class Bound { complex_pair, plus_one, minus_one, window };

/// t in (lower, upper), open; may reach to ±∞.
struct StableInterval {
  double lower, upper;
  Bound lower_bound, upper_bound;
};

/// A plane curve t -> (x(t), y(t)).
struct Curve {
  Polynomial x, y;
};

/// Axis-aligned window of the X-Y plane.
struct Window {
  double x_min, x_max, y_min, y_max;
};

/// A smooth piece of the boundary: points in order, and which condition binds there.
struct BoundaryArc {
  Bound bound;
  std::vector<double> x, y;
};

/// For each X of a smooth piece of the region, the Y between which it is stable.
struct RegionPiece {
  std::vector<double> x, y_lower, y_upper;
};

/// The largest Y of the region, where it is, and how far it reaches along the axes.
struct RegionConstants {
  double y_max;               // supremum of Y; ∞ where unbounded
  double x_at_y_max;          // NaN where unbounded
  bool y_max_attained;        // powers of A stay bounded at the apex itself
  double real_interval;       // sup X on Y = 0
  double imaginary_interval;  // √ sup Y on X = 0, neutral counted; 0 where none
  bool covers_quadrant;       // every X > 0, Y > 0 is stable: no positive semidefinite D, K limits h
};

/// x X + y Y <= bound.
struct HalfPlane {
  double x, y, bound;
};

/// The best line for Rayleigh damping from (x0, 0): X = x0 + slope·Y is stable or neutral for 0 < Y < reach.
struct DampingLine {
  double slope;
  double reach;  // 0 where no line leaves (x0, 0) into the region; ∞ where nothing ends it
};

class StabilityRegion {
 public:
  /// Throws std::invalid_argument for a method that carries more than x and v.
  explicit StabilityRegion(const Method& method);
  StabilityRegion(StabilityRegion&&) noexcept;
  ~StabilityRegion();

  /// Maximal open intervals of t in (t_min, t_max) along which both |λ| < 1, ascending.
  std::vector<StableInterval> stable_intervals(const Curve& curve, double t_min, double t_max) const;

  /// The first t > 0 at which a mode that is stable or neutral just after t = 0 turns unstable:
  /// 0 if it is unstable at once, ∞ if never.
  double first_exit(const Curve& curve) const;

  /// Largest H such that the mode (k [1/s²], d [1/s]), both >= 0, is stable or neutral at each 0 < h < H [s].
  /// A rigid mode (k = d = 0) never limits h: ∞. Scales exactly: f(s²k, sd) = f(k, d)/s.
  double critical_step(double k, double d) const;

  /// The same for a mode of which the physics lets motions grow, k or d < 0. Where both do (k > 0, or k = 0
  /// beside a rigid one) nothing limits h: ∞. Where k < 0 one grows and one decays: at each 0 < h < H no more
  /// than one eigenvalue is outside the unit circle.
  double critical_step_beside_growth(double k, double d) const;

  const RegionConstants& constants() const { return constants_; }

  /// Whether the two methods have the same conditions, as a linearized one and the one inside.
  bool same_conditions(const StabilityRegion& other) const;

  DampingLine damping_line(double x0) const;

  /// Whether every point from (x0, y0) to (x1, y1), ends included, is stable or neutral: Jury's conditions
  /// hold to 1e-11 at all their extremes between.
  bool closed_segment_is_stable(double x0, double y0, double x1, double y1) const;

  /// Where only λ = -1 ends stability in the quadrant X, Y >= 0, and 1 + T + Δ >= 0 is a half-plane that is
  /// exact for matrices: a method of one force a step, whose λ² - Tλ + Δ is affine in hD' and h²K'. Then for
  /// any symmetric positive semidefinite D', K', which need not commute, the method is stable for
  /// x hD' + y h²K' < bound and, as λ² - Tλ + Δ has a negative eigenvalue at -1 and none at -∞, unstable
  /// beyond (theory: symplectic Euler's limit is the root of λ_max(2hD' + h²K') = 4).
  std::optional<HalfPlane> exact_condition() const;

  /// Area inside the window, to about 12 digits. These four throw std::invalid_argument for an empty window.
  double area(const Window& window) const;

  std::vector<BoundaryArc> boundary(const Window& window) const;
  std::vector<RegionPiece> pieces(const Window& window) const;

  /// The smallest window that holds the whole region, with `margin` of its size added on each side;
  /// [-8, 8]² where the region is unbounded.
  Window natural_window(double margin) const;

 private:
  struct Column;
  struct Piece;

  Column column(double x, double y_min, double y_max) const;
  std::vector<Piece> smooth_pieces(const std::vector<double>& grid, double y_min, double y_max) const;
  void find_breaks(Column left, const Column& right, double y_min, double y_max,
                   std::vector<double>& breaks) const;
  std::vector<Piece> pieces_of(const Window& window) const;
  std::vector<Column> sample(const Piece& piece, const Window& window) const;
  void append_vertical_arcs(const std::vector<Piece>& all, const Window& window,
                            std::vector<BoundaryArc>& arcs) const;
  RegionConstants find_constants() const;
  bool powers_bounded_at(double x, double y) const;
  std::pair<double, double> highest_point(const Piece& piece) const;

  std::vector<RationalFunction> amplification_;  // 2x2, row by row
  std::array<RationalFunction, 3> jury_;         // indexed by Bound
  std::vector<Piece> all_pieces_;                // of the whole plane
  RegionConstants constants_;
};

/// The region of that method, computed once and kept as long as the program runs: for copies of the same
/// Method. (For one of many parameters tried, construct a StabilityRegion.)
const StabilityRegion& stability_region(const Method& method);

}  // namespace springstab
