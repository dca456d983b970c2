// The laws of a stability region: what is known of it in closed form, and what a raster of spectral radii
// says.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/regions/amplification.h"
#include "analysis/regions/polynomial.h"
#include "analysis/regions/stability_region.h"
#include "oracles.h"

BOOST_AUTO_TEST_SUITE(stability_region)

using namespace springstab;
using oracles::Complex;
using oracles::Point;

namespace {

const double inf = std::numeric_limits<double>::infinity();

const StabilityRegion& region_of(std::string_view method) { return springstab::stability_region(method); }

std::vector<double> radii(std::string_view method, const std::vector<Point>& points) {
  std::vector<double> x, y, rho(points.size());
  for (const Point& p : points) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  spectral_radius(method, x, y, rho);
  return rho;
}

double radius(std::string_view method, double x, double y) { return radii(method, {{x, y}})[0]; }

std::vector<Point> random_points(const Window& w, int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> x(w.x_min, w.x_max), y(w.y_min, w.y_max);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    const double first = x(random);
    points.push_back({first, y(random)});
  }
  return points;
}

/// Midpoints of n × n cells.
std::vector<Point> cells(const Window& w, int n) {
  std::vector<Point> points;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      points.push_back(
          {w.x_min + (w.x_max - w.x_min) * (i + 0.5) / n, w.y_min + (w.y_max - w.y_min) * (j + 0.5) / n});
  return points;
}

/// A method's region as inequalities, for points off its boundary.
struct Inequalities {
  std::string_view method;
  bool (*stable)(double x, double y);
};

// Paper Eqs. 22-24; theory §2 for the others.
const Inequalities inequalities[] = {
    {"explicit-euler", [](double x, double y) { return y > 0 && y < x && y > 2 * x - 4; }},
    {"symplectic-euler", [](double x, double y) { return x > 0 && y > 0 && y < 4 - 2 * x; }},
    {"implicit-euler",
     [](double x, double y) { return (x + y > 0 && y > 0 && y > -4 - 2 * x) || (y < 0 && y < -4 - 2 * x); }},
};

/// The boundary above the parabola, R(z) = e^{iθ} from z = 0 on, followed by Newton's method: the independent
/// description of the region of a method that has a polynomial R.
class ComplexBoundary {
 public:
  explicit ComplexBoundary(const oracles::Oracle& oracle) : taylor_(oracle.taylor) {}

  /// The next point of the curve; θ must not jump.
  Complex z(double theta) {
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(theta - theta_) / 0.02)));
    const double start = theta_;
    for (int i = 1; i <= steps; ++i) {
      theta_ = start + (theta - start) * i / steps;
      for (int newton = 0; newton < 8; ++newton) {
        const auto [value, slope] = evaluate(z_);
        z_ -= (value - std::polar(1.0, theta_)) / slope;
      }
    }
    return z_;
  }
  /// dz/dθ at the point just given.
  Complex rate() const {
    const auto [value, slope] = evaluate(z_);
    return Complex(0, 1) * value / slope;
  }
  /// θ runs to this, where the curve reaches the real axis: R has that many zeros inside the closed curve.
  double end() const { return std::numbers::pi * static_cast<double>(taylor_.size() - 1); }
  std::vector<double> taylor() const { return taylor_; }

 private:
  std::pair<Complex, Complex> evaluate(Complex z) const {
    Complex value = 0, slope = 0;
    for (auto c = taylor_.rbegin(); c != taylor_.rend(); ++c) {
      slope = slope * z + value;
      value = value * z + *c;
    }
    return {value, slope};
  }
  std::vector<double> taylor_;
  Complex z_ = 0;
  double theta_ = 0;
};

/// Area of the region in the X-Y plane. Pairs of real roots in (-L, 0): X = -(z₁ + z₂), Y = z₁z₂ has the
/// Jacobian z₁ - z₂, in all L³/6. Complex pairs a ± ib: X = -2a, Y = a² + b² has 4b, in all ∮ -2b² da.
double closed_form_area(const oracles::Oracle& oracle, double real_interval) {
  static constexpr std::array<double, 4> node{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                              0.9602898564975363};
  static constexpr std::array<double, 4> weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                0.1012285362903763};  // Gauss-Legendre, 8 points
  ComplexBoundary boundary(oracle);
  const int panels = 400;
  const double half = boundary.end() / (2 * panels);
  double area = std::pow(real_interval, 3) / 6;
  for (int p = 0; p < panels; ++p)
    for (int i = 0; i < 8; ++i) {
      const std::size_t j = static_cast<std::size_t>(i < 4 ? 3 - i : i - 4);
      const Complex z = boundary.z(half * (2 * p + 1 + (i < 4 ? -node[j] : node[j])));
      area += half * weight[j] * -2 * z.imag() * z.imag() * boundary.rate().real();
    }
  return area;
}

/// The upper end of the stable intervals of Y at X.
double top(const StabilityRegion& region, double x) {
  const auto intervals = region.stable_intervals({{{x}}, {{0, 1}}}, -inf, inf);
  BOOST_TEST_REQUIRE(!intervals.empty());
  return intervals.back().upper;
}

}  // namespace

BOOST_AUTO_TEST_CASE(constants_to_ten_digits) {
  const double s2 = std::numbers::sqrt2;
  const struct {
    std::string_view method;
    double y_max, x_at_y_max;
    bool attained;
    double real_interval, imaginary_interval;
    bool covers_quadrant;
  } expected[] = {
      {"explicit-euler", 4, 4, false, 2, 0, false},
      {"rk2", 2 + 2 * s2, 2 + s2, true, 2, 0, false},
      {"rk4", 8.7623104291285, 0.8254052495503, true, 2.785293563405, 2 * s2, false},
      {"implicit-euler", inf, NAN, false, inf, inf, true},
      {"symplectic-euler", 4, 0, false, 2, 2, false},
  };
  const auto equal = [](double a, double b) { return a == b || std::abs(a - b) <= 1e-10 * std::max(1.0, b); };
  for (const auto& e : expected) {
    const RegionConstants& c = region_of(e.method).constants();
    BOOST_TEST(equal(c.y_max, e.y_max), e.method << ": y_max " << c.y_max);
    BOOST_TEST((std::isnan(e.x_at_y_max) ? std::isnan(c.x_at_y_max) : equal(c.x_at_y_max, e.x_at_y_max)),
               e.method << ": x_at_y_max " << c.x_at_y_max);
    BOOST_TEST(c.y_max_attained == e.attained, e.method);
    BOOST_TEST(equal(c.real_interval, e.real_interval), e.method << ": real interval " << c.real_interval);
    BOOST_TEST(equal(c.imaginary_interval, e.imaginary_interval),
               e.method << ": imaginary interval " << c.imaginary_interval);
    BOOST_TEST(c.covers_quadrant == e.covers_quadrant, e.method);
  }
}

// Attained or not is what powers of A at the apex do.
BOOST_AUTO_TEST_CASE(powers_at_the_apex_stay_bounded_where_it_is_attained) {
  for (const Method& method : all_methods()) {
    const RegionConstants& c = region_of(method.name()).constants();
    if (!std::isfinite(c.y_max)) continue;
    const Eigen::Matrix2d a = method.amplification(c.x_at_y_max, c.y_max);
    Eigen::Matrix2d power = Eigen::Matrix2d::Identity();
    double early = 0, late = 0;
    for (int n = 1; n <= 4000; ++n) {
      power = power * a;
      (n <= 500 ? early : late) = std::max(n <= 500 ? early : late, power.norm());
    }
    BOOST_TEST((late < 2 * early) == c.y_max_attained, method.name() << ": " << early << ", later " << late);
  }
}

BOOST_AUTO_TEST_CASE(the_papers_inequalities_decide_the_same_points) {
  for (const auto& [method, stable] : inequalities) {
    const std::vector<Point> points = random_points({-9, 9, -12, 9}, 4000, 1);
    const std::vector<double> rho = radii(method, points);
    int inside = 0, outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(rho[i] - 1) < 1e-9) continue;
      const bool expected = stable(points[i].x, points[i].y);
      ++(expected ? inside : outside);
      BOOST_TEST((rho[i] < 1) == expected, method << " at (" << points[i].x << ", " << points[i].y << ")");
    }
    BOOST_TEST(inside > 20, method);
    BOOST_TEST(outside > 1000, method);
  }
}

// Paper Appendix A: with hμ = P + Q√D, D = X² - 4Y, stability is A.1 for D < 0 and A.2-A.4 otherwise.
BOOST_AUTO_TEST_CASE(the_papers_p_and_q_decide_the_same_cells) {
  const struct {
    std::string_view method;
    double (*p)(double x, double y);
    double (*q)(double x, double y);
  } expressions[] = {
      {"explicit-euler", [](double x, double) { return -x / 2; }, [](double, double) { return 0.5; }},
      {"rk4",
       [](double x, double y) {
         return -x / 2 + x * x / 4 - x * x * x / 12 + x * x * x * x / 48 - y / 2 + x * y / 4 -
                x * x * y / 12 + y * y / 24;
       },
       [](double x, double y) { return -0.5 + x / 4 - x * x / 12 + x * x * x / 48 + y / 12 - x * y / 24; }},
  };
  for (const auto& e : expressions) {
    const std::vector<Point> points = cells({-1.03, 6.1, -1.07, 9.3}, 150);
    const std::vector<double> rho = radii(e.method, points);
    int inside = 0, outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(rho[i] - 1) < 1e-9) continue;
      const auto [x, y] = points[i];
      const double p = e.p(x, y), q = e.q(x, y), d = x * x - 4 * y;
      const bool stable = d < 0 ? p * p - d * q * q < -2 * p
                                : -2 < p && p < 0 && p * p > d * q * q && (p + 2) * (p + 2) > d * q * q;
      ++(stable ? inside : outside);
      BOOST_TEST((rho[i] < 1) == stable, e.method << " at (" << x << ", " << y << "), rho = " << rho[i]);
    }
    BOOST_TEST(inside > 1000, e.method);
    BOOST_TEST(outside > 1000, e.method);
  }
}

BOOST_AUTO_TEST_CASE(areas) {
  const auto area = [](std::string_view method) {
    const StabilityRegion& region = region_of(method);
    return region.area(region.natural_window(0.07));
  };
  BOOST_TEST(std::abs(area("explicit-euler") - 4) < 1e-10);
  BOOST_TEST(std::abs(area("symplectic-euler") - 4) < 1e-10);
  BOOST_TEST(std::abs(area("rk2") - (4 + 2 * std::numbers::pi)) < 1e-10);
  BOOST_TEST(std::abs(area("rk4") - 34.574) < 5e-4);
  for (const oracles::Oracle& oracle : oracles::all()) {
    if (oracle.taylor.empty()) continue;
    const double expected = closed_form_area(oracle, region_of(oracle.method).constants().real_interval);
    BOOST_TEST(std::abs(area(oracle.method) - expected) < 1e-9,
               oracle.method << ": " << area(oracle.method) << ", by the curve R(z) = e^iθ " << expected);
  }
  const StabilityRegion& rk4 = region_of("rk4");
  BOOST_TEST(std::abs(rk4.area({0, 7, -1, 10}) - 32.573) < 5e-4);
  BOOST_TEST(std::abs(rk4.area({0, 7, -1, 10}) + rk4.area({-1, 0, -1, 10}) - area("rk4")) < 1e-10);
  const StabilityRegion& implicit_euler = region_of("implicit-euler");
  BOOST_TEST(std::abs(implicit_euler.area({-8, 8, -8, 8}) - (92 + 64)) < 1e-9);
  BOOST_TEST(std::abs(implicit_euler.area({-5, 3, -2, 6}) - (35 + 7)) < 1e-9);
  BOOST_TEST(implicit_euler.area({1, 2, -4, -1}) == 0);
  BOOST_TEST(std::abs(implicit_euler.area({1, 2, 3, 5}) - 2) < 1e-12);
}

BOOST_AUTO_TEST_CASE(counts_of_raster_cells_converge_to_the_area) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const Window w = region.natural_window(0.1);
    const double area = region.area(w), width = w.x_max - w.x_min, height = w.y_max - w.y_min;
    for (const int n : {100, 400}) {
      std::mt19937_64 random(
          8);  // a point somewhere in each cell: a lattice would fall along the straight edges
      std::uniform_real_distribution<double> within(-0.5, 0.5);
      std::vector<Point> points = cells(w, n);
      for (Point& p : points) p = {p.x + within(random) * width / n, p.y + within(random) * height / n};
      const std::vector<double> rho = radii(method.name(), points);
      const auto stable = std::count_if(rho.begin(), rho.end(), [](double r) { return r < 1; });
      const double cell = width * height / n / n, counted = static_cast<double>(stable) * cell;
      // The boundary cuts at most about 4n cells, each a coin toss: five standard deviations.
      BOOST_TEST(std::abs(counted - area) < 5 * 0.5 * std::sqrt(4 * n) * cell,
                 method.name() << ": " << counted << " by " << n << "² cells, " << area);
    }
  }
}

BOOST_AUTO_TEST_CASE(rk4_has_two_apexes_and_a_sliver_of_negative_damping) {
  const StabilityRegion& region = region_of("rk4");
  // Along R(z) = e^iθ: where Y = |z|² peaks, and where X = -2 Re z is smallest.
  ComplexBoundary boundary(*oracles::find("rk4"));
  std::vector<Point> points;
  for (double theta = 1e-3; theta < boundary.end(); theta += 1e-3) {
    const Complex z = boundary.z(theta);
    points.push_back({-2 * z.real(), std::norm(z)});
  }
  std::vector<Point> peaks;
  Point leftmost{0, 0};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point &a = points[i - 1], &b = points[i], &c = points[i + 1];
    const auto vertex = [](double u, double v, double w) { return (u - w) / (2 * (u - 2 * v + w)); };
    const auto at = [&](double s) {  // the parabolas through the three samples
      return Point{b.x + s * (c.x - a.x) / 2 + s * s * (a.x - 2 * b.x + c.x) / 2,
                   b.y + s * (c.y - a.y) / 2 + s * s * (a.y - 2 * b.y + c.y) / 2};
    };
    if (b.y > a.y && b.y > c.y) peaks.push_back(at(vertex(a.y, b.y, c.y)));
    if (b.x < a.x && b.x < c.x && b.x < leftmost.x) leftmost = at(vertex(a.x, b.x, c.x));
  }
  BOOST_TEST_REQUIRE(peaks.size() == 2u);
  BOOST_TEST(std::abs(peaks[0].x - region.constants().x_at_y_max) < 1e-6);
  BOOST_TEST(std::abs(peaks[0].y - region.constants().y_max) < 1e-9);
  BOOST_TEST(std::abs(peaks[1].x - 5.219) < 5e-4);
  BOOST_TEST(std::abs(peaks[1].y - 8.144) < 5e-4);
  BOOST_TEST(std::abs(leftmost.x + 0.4745) < 4e-4);  // theory: to X = -0.4745

  // Each of them is on the boundary that the region found.
  BOOST_TEST(std::abs(top(region, peaks[1].x) - peaks[1].y) < 1e-9);
  for (const double dx : {-0.05, 0.05}) BOOST_TEST(top(region, peaks[1].x + dx) < peaks[1].y);
  const Window w = region.natural_window(0);
  BOOST_TEST(std::abs(w.x_min - leftmost.x) < 1e-6);
  BOOST_TEST(std::abs(w.x_max - 2 * region.constants().real_interval) < 1e-9);  // both roots at -2.785...
}

BOOST_AUTO_TEST_CASE(every_boundary_point_has_radius_one_and_only_one_stable_side) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const Window window = region.natural_window(0.1);
    const auto arcs = region.boundary(window);
    BOOST_TEST(!arcs.empty(), method.name());
    int sides = 0;
    for (BoundaryArc arc : arcs) {
      BOOST_TEST_REQUIRE(arc.x.size() == arc.y.size());
      BOOST_TEST_REQUIRE(arc.x.size() >= 2u);
      if (arc.x.size() == 2) {  // a vertical arc is its two ends: look in between, too
        const std::vector<double> y{arc.y[0], arc.y[1]};
        arc.x.assign(11, arc.x[0]);
        arc.y.clear();
        for (int i = 0; i <= 10; ++i) arc.y.push_back(y[0] + (y[1] - y[0]) * i / 10);
      }
      BOOST_TEST((arc.bound != Bound::window));
      const auto distance = [&](std::size_t i, std::size_t j) {
        return std::hypot(arc.x[i] - arc.x[j], arc.y[i] - arc.y[j]);
      };
      const double length = distance(0, arc.x.size() - 1);
      for (std::size_t i = 0; i < arc.x.size(); ++i) {
        const double x = arc.x[i], y = arc.y[i], rho = radius(method.name(), x, y);
        // Where λ₁ and λ₂ meet, a rounding error moves them by its square root.
        const Eigen::Matrix2d a = method.amplification(x, y);
        const double error = std::max(1e-9, 10 * oracles::eigenvalues(a, a.cwiseAbs()).error);
        BOOST_TEST(std::abs(rho - 1) <= std::max(error, 1e-9),
                   method.name() << " at (" << x << ", " << y << "): rho - 1 = " << rho - 1);
        const double off = 1e-5;  // away from vertices, where other arcs come near
        if (i == 0 || i + 1 == arc.x.size() || distance(0, i) < 0.1 * length ||
            distance(i, arc.x.size() - 1) < 0.1 * length || length < 0.1)
          continue;
        const double dx = arc.x[i + 1] - arc.x[i - 1], dy = arc.y[i + 1] - arc.y[i - 1],
                     d = std::hypot(dx, dy);
        const double left = radius(method.name(), x - off * dy / d, y + off * dx / d);
        const double right = radius(method.name(), x + off * dy / d, y - off * dx / d);
        BOOST_TEST((left < 1) != (right < 1), method.name() << " at (" << x << ", " << y << "), bound "
                                                            << static_cast<int>(arc.bound) << ": " << left
                                                            << ", " << right);
        ++sides;
        // The bound says which eigenvalue is on the circle.
        const auto value = oracles::eigenvalues(a, a.cwiseAbs()).value;
        const auto at = [&](Complex lambda) {
          return std::min(std::abs(value[0] - lambda), std::abs(value[1] - lambda)) < 1e-6;
        };
        if (arc.bound == Bound::plus_one)
          BOOST_TEST(at(1), method.name() << " at (" << x << ", " << y << ")");
        if (arc.bound == Bound::minus_one)
          BOOST_TEST(at(-1), method.name() << " at (" << x << ", " << y << ")");
        if (arc.bound == Bound::complex_pair)
          BOOST_TEST(std::abs(a.determinant() - 1) < 1e-6, method.name() << " at (" << x << ", " << y << ")");
      }
    }
    BOOST_TEST(sides > 100, method.name());
  }
}

// Nothing is missing from the boundary: where the raster changes from stable to not, an arc is near.
BOOST_AUTO_TEST_CASE(the_raster_changes_only_at_the_boundary) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const Window w = region.natural_window(0.1);
    const auto arcs = region.boundary(w);
    constexpr int n = 60;
    const std::vector<Point> points = cells(w, n);
    const std::vector<double> rho = radii(method.name(), points);
    const double cell = std::hypot((w.x_max - w.x_min) / n, (w.y_max - w.y_min) / n);
    const auto gap = [&](const Point& p) {  // to the nearest segment
      double nearest = inf;
      for (const BoundaryArc& arc : arcs)
        for (std::size_t i = 0; i + 1 < arc.x.size(); ++i) {
          const double dx = arc.x[i + 1] - arc.x[i], dy = arc.y[i + 1] - arc.y[i];
          const double square = dx * dx + dy * dy;
          double t = square > 0 ? ((p.x - arc.x[i]) * dx + (p.y - arc.y[i]) * dy) / square : 0;
          t = std::clamp(t, 0.0, 1.0);
          nearest = std::min(nearest, std::hypot(arc.x[i] + t * dx - p.x, arc.y[i] + t * dy - p.y));
        }
      return nearest;
    };
    int changes = 0;
    for (std::size_t j = 0; j + 1 < n; ++j)
      for (std::size_t i = 0; i + 1 < n; ++i)
        for (const std::size_t neighbour : {j * n + i + 1, (j + 1) * n + i}) {
          if ((rho[j * n + i] < 1) == (rho[neighbour] < 1)) continue;
          ++changes;
          BOOST_TEST(gap(points[j * n + i]) <= cell,
                     method.name() << " near (" << points[j * n + i].x << ", " << points[j * n + i].y << ")");
        }
    BOOST_TEST(changes > 50, method.name());
  }
}

BOOST_AUTO_TEST_CASE(filled_pieces_are_stable_and_add_up_to_the_area) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const Window window = region.natural_window(0.1);
    double sum = 0;
    for (const RegionPiece& piece : region.pieces(window)) {
      for (std::size_t i = 0; i + 1 < piece.x.size(); ++i) {
        const double heights =
            piece.y_upper[i] - piece.y_lower[i] + piece.y_upper[i + 1] - piece.y_lower[i + 1];
        sum += heights / 2 * (piece.x[i + 1] - piece.x[i]);
        if (piece.y_upper[i] - piece.y_lower[i] > 1e-6) {
          const double middle = (piece.y_lower[i] + piece.y_upper[i]) / 2;
          BOOST_TEST(radius(method.name(), piece.x[i], middle) < 1,
                     method.name() << " at (" << piece.x[i] << ", " << middle << ")");
        }
      }
    }
    const double area = region.area(window);
    BOOST_TEST(std::abs(sum - area) < 2e-3 * area, method.name() << ": " << sum << " of " << area);
  }
}

BOOST_AUTO_TEST_CASE(the_natural_window_is_the_smallest_that_holds_the_region) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const Window w = region.natural_window(0);
    if (!std::isfinite(region.constants().y_max)) {
      BOOST_TEST((w.x_min == -8 && w.x_max == 8 && w.y_min == -8 && w.y_max == 8), method.name());
      continue;
    }
    const double dx = w.x_max - w.x_min, dy = w.y_max - w.y_min;
    const Window wide{w.x_min - dx, w.x_max + dx, w.y_min - dy, w.y_max + dy};
    for (const Point& p : random_points(wide, 4000, 2)) {
      const bool inside = p.x > w.x_min && p.x < w.x_max && p.y > w.y_min && p.y < w.y_max;
      if (!inside)
        BOOST_TEST(radius(method.name(), p.x, p.y) >= 1, method.name()
                                                             << " at (" << p.x << ", " << p.y << ")");
    }
    const double all = region.area(wide), thin = 1e-3;
    BOOST_TEST(std::abs(region.area(w) - all) < 1e-9 * all, method.name());
    BOOST_TEST(region.area({w.x_min, w.x_min + thin * dx, w.y_min, w.y_max}) > 0, method.name());
    BOOST_TEST(region.area({w.x_max - thin * dx, w.x_max, w.y_min, w.y_max}) > 0, method.name());
    BOOST_TEST(region.area({w.x_min, w.x_max, w.y_min, w.y_min + thin * dy}) > 0, method.name());
    BOOST_TEST(region.area({w.x_min, w.x_max, w.y_max - thin * dy, w.y_max}) > 0, method.name());
    const Window margin = region.natural_window(0.25);
    BOOST_TEST(std::abs(margin.x_min - (w.x_min - 0.25 * dx)) < 1e-12 * dx, method.name());
    BOOST_TEST(std::abs(margin.y_max - (w.y_max + 0.25 * dy)) < 1e-12 * dy, method.name());
  }
}

BOOST_AUTO_TEST_CASE(intervals_along_lines_and_parabolas_are_where_the_radius_is_below_one) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> offset(-1, 6), slope(-3, 3);
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    int stable = 0, unstable = 0;
    for (int line = 0; line < 60; ++line) {
      const Curve curve{{{offset(random), slope(random)}},
                        {{offset(random), slope(random), line % 2 ? 0 : slope(random) / 3}}};
      const auto intervals = region.stable_intervals(curve, -4, 5);
      for (std::size_t i = 0; i < intervals.size(); ++i) {
        BOOST_TEST(intervals[i].lower < intervals[i].upper, method.name());
        if (i > 0) BOOST_TEST(intervals[i - 1].upper <= intervals[i].lower, method.name());
      }
      std::vector<Point> points;
      std::vector<double> at;
      for (int i = 0; i < 300; ++i) {
        at.push_back(-4 + 9 * (i + 0.37) / 300);
        points.push_back({curve.x(at.back()), curve.y(at.back())});
      }
      const std::vector<double> rho = radii(method.name(), points);
      for (std::size_t i = 0; i < rho.size(); ++i) {
        if (std::abs(rho[i] - 1) < 1e-9) continue;
        const bool in = std::any_of(intervals.begin(), intervals.end(), [&](const StableInterval& s) {
          return at[i] > s.lower && at[i] < s.upper;
        });
        ++(in ? stable : unstable);
        BOOST_TEST(in == (rho[i] < 1), method.name() << " at (" << points[i].x << ", " << points[i].y << ")");
      }
    }
    BOOST_TEST(stable > 300, method.name());
    BOOST_TEST(unstable > 300, method.name());
  }
}

BOOST_AUTO_TEST_CASE(the_best_damping_line_is_neutral_or_stable_and_none_reaches_higher) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    if (region.constants().covers_quadrant) {
      BOOST_TEST(region.damping_line(0.7).reach == inf, method.name());
      continue;
    }
    for (const double fraction : {0.0, 0.13, 0.37, 0.6, 0.85}) {
      const double x0 = fraction * region.constants().real_interval;
      const DampingLine best = region.damping_line(x0);
      BOOST_TEST(best.reach > 0, method.name() << " from " << x0);
      BOOST_TEST(best.slope >= 0, method.name() << " from " << x0);
      const auto worst = [&](double slope_of_line, double reach) {
        std::vector<Point> points;
        for (int i = 0; i < 250; ++i) {
          const double y = reach * (i + 1) / 250;
          points.push_back({x0 + slope_of_line * y, y});
        }
        const std::vector<double> rho = radii(method.name(), points);
        return *std::max_element(rho.begin(), rho.end());
      };
      BOOST_TEST(worst(best.slope, best.reach * (1 - 1e-9)) <= 1 + 1e-9, method.name() << " from " << x0);
      for (const double aside : {-1e-3, -1e-4, -1e-5, 1e-5, 1e-4, 1e-3}) {
        const double reach = region.first_exit({{{x0, best.slope + aside}}, {{0, 1}}});
        if (best.slope + aside >= 0)
          BOOST_TEST(reach <= best.reach * (1 + 1e-9), method.name()
                                                           << " from " << x0 << ", aside by " << aside);
      }
      for (int i = 0; i < 300; ++i) {
        const double slope_of_line = std::tan(1.5 * (i + 0.1) / 300);
        BOOST_TEST(worst(slope_of_line, 1.002 * best.reach) > 1 + 1e-9,
                   method.name() << " from " << x0 << ": slope " << slope_of_line << " reaches beyond "
                                 << best.reach << " of slope " << best.slope);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(radii_in_lanes_are_those_of_the_matrix) {
  for (const Method& method : all_methods()) {
    for (const int count : {0, 1, 7, 8, 9, 21}) {
      std::vector<Point> points = random_points({-6, 8, -6, 9}, count, 4);
      if (count > 4) points[3] = {1, -2};  // a pole of implicit Euler must not spoil its neighbours
      const std::vector<double> rho = radii(method.name(), points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto [x, y] = points[i];
        const Eigen::Matrix2d a = method.amplification(x, y);
        if (!a.allFinite()) {
          BOOST_TEST(rho[i] == inf, method.name() << " at (" << x << ", " << y << ")");
          continue;
        }
        const auto [value, error] = oracles::eigenvalues(a, a.cwiseAbs());
        const double expected = std::max(std::abs(value[0]), std::abs(value[1]));
        BOOST_TEST(std::abs(rho[i] - expected) <= error, method.name() << " at (" << x << ", " << y << ")");
      }
    }
  }
  BOOST_TEST(!Method("implicit-euler").amplification(1, -2).allFinite());
  BOOST_TEST(radius("implicit-euler", 1, -2) == inf);
  BOOST_TEST(radius("rk4", 1e200, 1) == inf);
  std::vector<double> two(2), three(3);
  BOOST_CHECK_THROW(spectral_radius("rk2", two, two, three), std::invalid_argument);
  BOOST_CHECK_THROW(spectral_radius("rk2", two, three, two), std::invalid_argument);
}

// theory 4f: growth from 1 to the threshold T, or decay to 1/T, takes ln T / |ln ρ| steps; twice that covers
// the transient of a matrix that is not normal.
BOOST_AUTO_TEST_CASE(simulated_cells_agree_with_the_radius_outside_the_band) {
  constexpr double threshold = 1e6;
  for (const Method& method : all_methods()) {
    const Window w = region_of(method.name()).natural_window(0.15);
    const std::vector<Point> points = cells(w, 45);
    std::vector<double> x, y;
    for (const Point& p : points) {
      x.push_back(p.x);
      y.push_back(p.y);
    }
    const std::vector<double> rho = radii(method.name(), points);
    std::vector<CellFate> fate(points.size());
    std::size_t previous = points.size();
    for (const long steps : {128, 512}) {
      simulate_cells(method.name(), x, y, steps, threshold, fate);
      const double band = 2 * std::log(threshold) / static_cast<double>(steps);
      std::size_t outside = 0, decayed = 0, diverged = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::abs(rho[i] - 1) < band) continue;
        ++outside;
        const CellFate expected = rho[i] < 1 ? CellFate::decayed : CellFate::diverged;
        decayed += expected == CellFate::decayed;
        diverged += expected == CellFate::diverged;
        BOOST_TEST((fate[i] == expected), method.name()
                                              << " at (" << x[i] << ", " << y[i] << "), rho = " << rho[i]);
      }
      BOOST_TEST(decayed > 100u, method.name());
      BOOST_TEST(diverged > 100u, method.name());
      BOOST_TEST(points.size() - outside < previous, method.name() << ": the band does not shrink");
      previous = points.size() - outside;
    }
  }
  // Neutral modes neither decay nor diverge; a cell that overflows at once leaves its neighbours alone.
  const std::vector<double> x{0.0, 1.0, 1e300, 0.4, -1.0}, y{2.0, 0.5, 1e300, 0.0, 0.3};
  std::vector<CellFate> fate(x.size());
  simulate_cells("symplectic-euler", x, y, 3000, threshold, fate);
  const std::vector<CellFate> expected{CellFate::bounded, CellFate::decayed, CellFate::diverged,
                                       CellFate::bounded, CellFate::diverged};
  for (std::size_t i = 0; i < x.size(); ++i) BOOST_TEST((fate[i] == expected[i]), "cell " << i);
}

// theory §3: what the paper reports beside what is true.
BOOST_AUTO_TEST_CASE(errata_reported_and_computed) {
  const RegionConstants& rk4 = region_of("rk4").constants();
  const double reported_x = 0.725, reported_y = 8.75;
  BOOST_TEST_MESSAGE("RK4's apex, reported (" << reported_x << ", " << reported_y << "), computed ("
                                              << rk4.x_at_y_max << ", " << rk4.y_max << ")");
  BOOST_TEST(std::abs(radius("rk4", reported_x, reported_y) - 0.99876) < 5e-6);
  BOOST_TEST(rk4.y_max - reported_y > 0.012);
  BOOST_TEST(rk4.x_at_y_max - reported_x > 0.1);

  // Reported: Y < X is stable up to the line. Computed: on it, every mode is neutral, and (4, 4) is
  // defective.
  for (const double y : {0.1, 1.7, 2.9, 3.99})
    BOOST_TEST(std::abs(radius("explicit-euler", y, y) - 1) < 1e-12, "explicit Euler on Y = X = " << y);
  const Eigen::Matrix2d corner = Method("explicit-euler").amplification(4, 4);
  Eigen::Matrix2d power = corner;
  for (int n = 1; n < 1000; ++n) power = power * corner;
  BOOST_TEST(std::abs(power.norm() / 1000 - 5) < 0.01);

  // Reported: over-stable where d < 0 and k < 0. Computed: also with only one of them negative.
  BOOST_TEST(radius("implicit-euler", -3, -5) < 1);
  BOOST_TEST(radius("implicit-euler", -1, 2) < 1);  // d < 0 < k, X + Y > 0
  BOOST_TEST(radius("implicit-euler", 1, -7) < 1);  // k < 0 < d, Y < -4 - 2X
  BOOST_TEST(radius("implicit-euler", 1, -5) > 1);
  BOOST_TEST(radius("implicit-euler", -1, -1) > 1);  // and not on the whole quadrant
}

BOOST_AUTO_TEST_CASE(bad_arguments_are_refused) {
  const StabilityRegion& region = region_of("rk2");
  BOOST_TEST(&region == &region_of("rk2"));
  BOOST_CHECK_THROW(region_of("no-such-method"), std::invalid_argument);
  for (const Window& w :
       {Window{1, 1, 0, 1}, Window{0, 1, 2, 1}, Window{NAN, 1, 0, 1}, Window{0, 1, 0, NAN}}) {
    BOOST_CHECK_THROW(region.area(w), std::invalid_argument);
    BOOST_CHECK_THROW(region.boundary(w), std::invalid_argument);
    BOOST_CHECK_THROW(region.pieces(w), std::invalid_argument);
  }
  for (const auto& [k, d] : {std::pair{-1.0, 0.0}, {1.0, -1.0}, {double{NAN}, 1.0}, {inf, 1.0}, {1.0, inf}})
    BOOST_CHECK_THROW(region.critical_step(k, d), std::invalid_argument);
  const std::vector<double> two{1, 2}, three{1, 2, 3};
  std::vector<double> rho(2);
  std::vector<CellFate> fate(2);
  BOOST_CHECK_THROW(spectral_radius("rk2", two, three, rho), std::invalid_argument);
  BOOST_CHECK_THROW(spectral_radius("rk2", three, three, rho), std::invalid_argument);
  BOOST_CHECK_THROW(simulate_cells("rk2", two, three, 1, 2, fate), std::invalid_argument);
  BOOST_CHECK_THROW(simulate_cells("rk2", three, three, 1, 2, fate), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(real_roots_of_polynomials) {
  const auto product = [](const std::vector<double>& roots) {
    Polynomial p{{1}};
    for (const double r : roots) p = p * Polynomial{{-r, 1}};
    return p;
  };
  const auto check = [&](const std::vector<double>& roots, const Polynomial& factor, double error) {
    const std::vector<double> found = (product(roots) * factor).real_roots();
    BOOST_TEST_REQUIRE(found.size() == roots.size());
    for (std::size_t i = 0; i < roots.size(); ++i) {
      BOOST_TEST(std::abs(found[i] - roots[i]) <= error * std::abs(roots[i]),
                 found[i] << " for " << roots[i]);
      if (i > 0) BOOST_TEST(found[i - 1] <= found[i]);
    }
  };
  check({-3, -0.5, 1, 7}, {{1}}, 1e-14);
  check({-2}, {{5}}, 0);
  check({1, 2}, {{1, 0, 1}}, 1e-14);        // and the pair ±i
  check({1e-9, 1, 1e6}, {{-3e-8}}, 1e-12);  // of different size
  check({0.3, 1, 1}, {{1}}, 1e-6);          // a double root keeps half of the digits
  check({-1.5, -1.5, 2, 2}, {{1, 1, 1}}, 1e-6);
  // A simple root is as good as its polynomial can be evaluated there, also where coefficients differ in
  // size.
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1), exponent(-6, 6);
  int simple = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Polynomial p, size;
    for (int i = 0; i <= 8; ++i) {
      p.c.push_back(uniform(random) * std::pow(10, exponent(random)));
      size.c.push_back(std::abs(p.c.back()));
    }
    for (const double root : p.real_roots()) {
      if (std::abs(root * p.derivative()(root)) < 1e-3 * size(std::abs(root))) continue;  // nearly double
      ++simple;
      BOOST_TEST(std::abs(p(root)) <= 16 * oracles::epsilon * size(std::abs(root)), "root " << root);
    }
  }
  BOOST_TEST(simple > 200);
  BOOST_TEST(Polynomial{}.real_roots().empty());
  BOOST_TEST(Polynomial{{3}}.real_roots().empty());
  BOOST_TEST((Polynomial{{1, 0, 1}}).real_roots().empty());
  BOOST_TEST((Polynomial{{0, 0, 0, 2}}).real_roots() == std::vector<double>{0},
             boost::test_tools::per_element());
  BOOST_TEST((Polynomial{{0, 0, -3, 1}}).real_roots() == (std::vector<double>{0, 3}),
             boost::test_tools::per_element());
  const std::vector<double> trimmed = Polynomial{{-6, 2, 0, 0}}.real_roots();  // zero leading coefficients
  BOOST_TEST(trimmed == std::vector<double>{3}, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(sums_products_and_derivatives_of_polynomials) {
  const Polynomial p{{1, -2, 0, 4}}, q{{-3, 0.5}};
  for (const double t : {-1.3, 0.0, 0.7, 2.9}) {
    BOOST_TEST(p(t) == 1 - 2 * t + 4 * t * t * t, boost::test_tools::tolerance(1e-14));
    BOOST_TEST((p + q)(t) == p(t) + q(t), boost::test_tools::tolerance(1e-14));
    BOOST_TEST((p * q)(t) == p(t) * q(t), boost::test_tools::tolerance(1e-14));
    BOOST_TEST(p.derivative()(t) == -2 + 12 * t * t, boost::test_tools::tolerance(1e-14));
  }
  BOOST_TEST((p + Polynomial{{-1, 2, 0, -4}}).is_zero());
  BOOST_TEST((p * Polynomial{}).is_zero());
}

BOOST_AUTO_TEST_CASE(polynomials_in_x_and_y) {
  const BivariatePolynomial x = BivariatePolynomial::x(), y = BivariatePolynomial::y(), one = 1.0;
  const BivariatePolynomial p = one + x * 3 + -(x * y) + y * y * 0.5, q = one + x + y;
  for (const auto& [a, b] : random_points({-2, 3, -3, 2}, 50, 5)) {
    BOOST_TEST(p(a, b) == 1 + 3 * a - a * b + 0.5 * b * b, boost::test_tools::tolerance(1e-12));
    BOOST_TEST((p * q)(a, b) == p(a, b) * q(a, b), boost::test_tools::tolerance(1e-12));
    BOOST_TEST((p * p).derivative_x()(a, b) == 2 * p(a, b) * (3 - b), boost::test_tools::tolerance(1e-11));
    const Polynomial u{{a, 1, 0.3}}, v{{b, -2}};
    BOOST_TEST(p.along(u, v)(0.83) == p(u(0.83), v(0.83)), boost::test_tools::tolerance(1e-12));
  }
  BOOST_TEST(one.derivative_x()(3, 4) == 0);

  // What cancels leaves no noise behind: 0.1 + 0.2 is not 0.3.
  const BivariatePolynomial rest = x * 0.1 + x * 0.2 + -(x * 0.3);
  BOOST_TEST(rest.without_noise()(1, 1) == 0);
  BOOST_TEST((x * 1e-10 + one).without_noise()(1, 0) == 1 + 1e-10);  // small is not noise
  BOOST_TEST((x * 0.1 + x * 0.2 + -(y * 0.3)).along({{0, 1}}, {{0, 1}}).is_zero());

  const auto quotient = exact_quotient(p * q * q, q);
  BOOST_TEST_REQUIRE(quotient.has_value());
  for (const auto& [a, b] : random_points({-2, 3, -3, 2}, 20, 6))
    BOOST_TEST((*quotient)(a, b) == p(a, b) * q(a, b), boost::test_tools::tolerance(1e-11));
  BOOST_TEST(!exact_quotient(p * q + 1e-6, q).has_value());
  BOOST_TEST(!exact_quotient(p, q).has_value());
  BOOST_TEST(!exact_quotient(x, y).has_value());
  BOOST_TEST(!exact_quotient(one, q).has_value());
  BOOST_TEST((exact_quotient(p, p).value() == one));
}

BOOST_AUTO_TEST_CASE(rational_functions_cancel) {
  const RationalFunction x = BivariatePolynomial::x(), y = BivariatePolynomial::y(), one = 1.0;
  const RationalFunction pole = one + x + y;
  const RationalFunction f = x / pole + y * y / pole, g = (one - x * y) / (pole * pole);
  for (const auto& [a, b] : random_points({0.1, 3, 0.1, 2}, 30, 7)) {
    const double p = 1 + a + b, fv = (a + b * b) / p, gv = (1 - a * b) / (p * p);
    BOOST_TEST(f(a, b) == fv, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(std::abs(g(a, b) - gv) < 1e-13);
    BOOST_TEST(std::abs((f + g)(a, b) - (fv + gv)) < 1e-13);
    BOOST_TEST(std::abs((f - g)(a, b) - (fv - gv)) < 1e-13);
    BOOST_TEST(std::abs((f * g)(a, b) - fv * gv) < 1e-13);
    BOOST_TEST(std::abs((g / f)(a, b) - gv / fv) < 1e-12 * (1 + std::abs(gv / fv)));
  }
  BOOST_TEST((f * pole).denominator()(2, 3) == 1);
  BOOST_TEST((x / pole + (one + y) / pole).denominator()(2, 3) == 1);  // (1 + X + Y)/(1 + X + Y)
  BOOST_TEST(f.denominator()(2, 3) == 6);
  BOOST_TEST(g.denominator()(2, 3) == 36);
}

BOOST_AUTO_TEST_SUITE_END()
