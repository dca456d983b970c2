// The stable region of a method in the X-Y plane, X = hd and Y = h²k, and its exact boundary.
//
// Three conditions on the matrix A(X, Y) that the method's own step gives say where stability may end
// (characteristic.h): a complex pair on the unit circle, λ = 1, λ = -1. Along any polynomial curve
// (X(t), Y(t)) they are rational in t, so where they vanish is a polynomial root problem: columns, damping
// lines and the path of one mode as h grows are all such curves. No raster is involved. Between two roots
// the signs of the three decide for the 2x2 matrix of a method that carries nothing, else the eigenvalues
// at one point do. Methods of very many stages, and those that carry more than four vectors beyond x and v,
// are judged by sampled eigenvalues (sampled_curve.h). (A method with eigenvalues that are 0, 1 or -1 for all
// X and Y is judged by the others.)
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
#include "analysis/regions/characteristic.h"
#include "analysis/regions/matrix_form.h"

namespace springstab {

/// What ends a stable interval: one of the three conditions, or the window that was asked for.
enum class Bound { complex_pair, plus_one, minus_one, window };

/// t in (lower, upper), open; may reach to ±∞.
struct StableInterval {
  double lower, upper;
  Bound lower_bound, upper_bound;
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

class CurveConditions;

class StabilityRegion {
 public:
  explicit StabilityRegion(const Method& method);
  StabilityRegion(StabilityRegion&&) noexcept;
  ~StabilityRegion();

  /// Maximal open intervals of t in (t_min, t_max) along which every |λ| < 1, ascending.
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

  /// Whether undamped motion grows at every step: the imaginary interval is empty.
  bool amplifies() const { return constants_.imaginary_interval == 0; }

  /// Whether the two methods have the same conditions, as a linearized one and the one inside.
  bool same_conditions(const StabilityRegion& other) const;

  DampingLine damping_line(double x0) const;

  /// Whether every point from (x0, y0) to (x1, y1), ends included, is stable or neutral: the
  /// conditions hold to 1e-11 at all their extremes between, or |λ| <= 1 to 1e-10 between all their roots.
  bool closed_segment_is_stable(double x0, double y0, double x1, double y1) const;

  /// How the method's eigenvalues on matrices follow from this region.
  MatrixForm matrix_form() const { return matrix_form_; }

  /// Where only λ = -1 ends stability in the quadrant X, Y >= 0, and the step has scalar coefficients of
  /// degree 2, so that its condition is a half-plane. Then for any symmetric positive semidefinite D', K',
  /// which need not commute, the method is stable for λ_max(x hD' + y h²K') < bound and, as Q(λ) has a
  /// negative eigenvalue at -1 and none at -∞, unstable beyond (theory: symplectic Euler's limit is the root
  /// of λ_max(2hD' + h²K') = 4). y > 0; x < 0 where damping lets the step grow.
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

  CurveConditions along(const Curve& curve) const;
  Bound binding_at(double x, double y) const;  // of a point of the boundary

  Method method_;
  bool by_values_;  // not by the polynomial
  CharacteristicPolynomial polynomial_;
  std::array<RationalFunction, 3> jury_;  // indexed by Bound
  MatrixForm matrix_form_;
  std::vector<Piece> all_pieces_;  // of the whole plane
  RegionConstants constants_;
};

/// The region of that method, computed once and kept as long as the program runs: for copies of the same
/// Method. (For one of many parameters tried, construct a StabilityRegion.)
const StabilityRegion& stability_region(const Method& method);

}  // namespace springstab
