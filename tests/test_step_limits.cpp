// The laws of step limits: closed forms, brute force over steps and modes, and exact scaling with the time
// unit.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/limits/step_limits.h"
#include "analysis/method.h"
#include "analysis/regions/amplification.h"
#include "solvers/linear/dense_solvers.h"

BOOST_AUTO_TEST_SUITE(step_limits)

using namespace springstab;

namespace {

const double inf = std::numeric_limits<double>::infinity();

const StabilityRegion& region_of(std::string_view method) { return springstab::stability_region(method); }

/// The largest ρ over a number of points; brute force's only tool.
class LargestRadius {
 public:
  explicit LargestRadius(std::string_view method) : method_(method) {}

  void add(double x, double y) {
    x_.push_back(x);
    y_.push_back(y);
  }
  double take() {
    rho_.resize(x_.size());
    spectral_radius(method_, x_, y_, rho_);
    const double largest = rho_.empty() ? 0 : *std::max_element(rho_.begin(), rho_.end());
    x_.clear();
    y_.clear();
    return largest;
  }

 private:
  std::string_view method_;
  std::vector<double> x_, y_, rho_;
};

/// The largest ρ over the modes at one step. Modes k spread over their logarithm, both ends included; below
/// 1e-9 of k_max ρ cannot be told from 1.
double largest_radius(std::string_view method, const RayleighModes& m, double h, int samples) {
  LargestRadius largest(method);
  const double bottom = std::max(m.k_min, 1e-9 * m.k_max);
  for (int i = 0; i <= samples; ++i) {
    const double k =
        i == samples ? m.k_max : bottom * std::pow(m.k_max / bottom, static_cast<double>(i) / samples);
    largest.add(h * (m.d0 + m.alpha * k), h * h * k);
  }
  if (m.k_min == 0 && m.d0 > 0) largest.add(h * m.d0, 0);
  return largest.take();
}

std::vector<RayleighModes> random_modes(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(-2, 0.7), ratio(-6, 0), size(0, 5), uniform(0, 1);
  std::vector<RayleighModes> all;
  for (int i = 0; i < count; ++i) {
    RayleighModes m;
    m.k_max = std::pow(10, size(random));
    m.k_min = uniform(random) < 0.2 ? 0 : m.k_max * std::pow(10, ratio(random));
    const double rate = std::sqrt(m.k_max);
    if (uniform(random) < 0.75) m.d0 = rate * std::pow(10, exponent(random));
    if (uniform(random) < 0.75 || m.d0 == 0) m.alpha = std::pow(10, exponent(random)) / rate;
    all.push_back(m);
  }
  return all;
}

bool close(double a, double b, double tolerance) {
  return a == b || std::abs(a - b) <= tolerance * std::abs(b);
}

std::string text(const RayleighModes& m) {
  std::ostringstream out;
  out << "k in [" << m.k_min << ", " << m.k_max << "], d0 = " << m.d0 << ", alpha = " << m.alpha;
  return out.str();
}

/// Whether some alpha >= 0 makes the whole mode line of (h, d0, k_max = 1) stable or neutral.
bool some_alpha_works(std::string_view method, double h, double d0) {
  LargestRadius largest(method);
  const double start = h * d0, y = h * h;
  const auto stable = [&](double end,
                          int samples) {  // the segment from (h d0, 0) to (end, h²), both included
    for (int j = 0; j <= samples; ++j) largest.add(start + (end - start) * j / samples, y * j / samples);
    return largest.take() <= 1 + 1e-9;
  };
  for (int i = 0; i <= 1500; ++i) {
    const double end = start + 6.0 * i / 1500;  // no bounded region is wider
    if (stable(end, 1) && stable(end, 16) && stable(end, 400)) return true;
  }
  return false;
}

/// ρ over the designed line, the last sliver below its end left out.
double radius_of_design(std::string_view method, const DampingDesign& design, double k_max, double d0) {
  LargestRadius largest(method);
  const double h = design.h_max * (1 - 1e-9);
  for (int i = 1; i <= 2000; ++i) {
    const double k = k_max * i / 2000;
    largest.add(h * (d0 + design.alpha * k), h * h * k);
  }
  return largest.take();
}

}  // namespace

BOOST_AUTO_TEST_CASE(closed_forms_without_damping) {
  const RayleighModes modes{.k_min = 3, .k_max = 1700};
  const double omega = std::sqrt(1700);
  BOOST_TEST(critical_step(region_of("explicit-euler"), modes) == 0);
  BOOST_TEST(critical_step(region_of("rk2"), modes) == 0);
  BOOST_TEST(close(critical_step(region_of("rk4"), modes), 2 * std::numbers::sqrt2 / omega, 1e-12));
  BOOST_TEST(close(critical_step(region_of("symplectic-euler"), modes), 2 / omega, 1e-12));
  BOOST_TEST(critical_step(region_of("implicit-euler"), modes) == inf);
}

BOOST_AUTO_TEST_CASE(closed_forms_of_explicit_euler) {
  const StabilityRegion& region = region_of("explicit-euler");
  // Y < X: h k < d, at every k; Y > 2X - 4: h² k - 2 h d + 4 > 0.
  for (const RayleighModes& m : random_modes(20, 1)) {
    double expected = inf;
    for (int i = 0; i <= 4000; ++i) {
      const double bottom = std::max(m.k_min, 1e-12 * m.k_max);
      const double k = bottom * std::pow(m.k_max / bottom, i / 4000.0), d = m.d0 + m.alpha * k;
      expected = std::min(expected, d / k);
      const double inside = d * d - 4 * k;
      if (inside > 0) expected = std::min(expected, 4 / (d + std::sqrt(inside)));
    }
    if (m.d0 > 0 && m.k_min == 0) expected = std::min(expected, 2 / m.d0);
    BOOST_TEST(close(critical_step(region, m), expected, 1e-5),
               text(m) << ": " << critical_step(region, m) << ", expected " << expected);
    BOOST_TEST(critical_step(region, m) <= expected * (1 + 1e-9), text(m));
  }
  // Without d0 the softest mode's h < d/k = α is everyone's, while α is short enough for the stiffest.
  BOOST_TEST(close(critical_step(region, {.k_min = 5, .k_max = 900, .alpha = 0.01}), 0.01, 1e-12));
  BOOST_TEST(close(critical_step(region, {.k_max = 900, .alpha = 0.01}), 0.01, 1e-12));
  // Fixed damping on one mode: h = d/k.
  BOOST_TEST(close(critical_step(region, {.k_min = 900, .k_max = 900, .d0 = 3}), 3.0 / 900, 1e-12));
}

BOOST_AUTO_TEST_CASE(closed_form_of_symplectic_euler) {
  // theory 4b on each mode: 2 h d + h² k = 4. The limit is monotonic in neither k nor d alone, so all modes
  // count.
  for (const RayleighModes& m : random_modes(200, 2)) {
    const auto limit = [&](double k) {
      const double d = m.d0 + m.alpha * k;
      return d + k == 0 ? inf : 4 / (d + std::sqrt(d * d + 4 * k));
    };
    const double expected = limit(m.k_max);  // h falls as k and d grow together
    BOOST_TEST(close(critical_step(region_of("symplectic-euler"), m), expected, 1e-12), text(m));
  }
}

BOOST_AUTO_TEST_CASE(a_rigid_mode_never_limits) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    BOOST_TEST(region.critical_step(0, 0) == inf, method.name());
    BOOST_TEST(critical_step(region, {}) == inf, method.name());
    const RayleighModes with{.k_min = 0, .k_max = 40, .alpha = 0.1},
        without{.k_min = 1e-3, .k_max = 40, .alpha = 0.1};
    BOOST_TEST(close(critical_step(region, with), critical_step(region, without), 1e-9), method.name());
  }
  // A rigid mode in air is not rigid: h d0 is bounded by the real interval.
  BOOST_TEST(close(critical_step(region_of("rk4"), {.d0 = 5}), region_of("rk4").constants().real_interval / 5,
                   1e-12));
}

BOOST_AUTO_TEST_CASE(below_the_limit_all_is_stable_and_just_above_it_is_not) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    int limited = 0;
    for (const RayleighModes& m : random_modes(25, 3)) {
      const double limit = critical_step(region, m);
      const double scale = 10 / std::sqrt(m.k_max);
      for (int i = 0; i < 40; ++i) {
        const double h = std::min(limit, scale) * (i == 39 ? 1 - 1e-9 : (i + 0.5) / 39.5);
        if (h == 0) continue;
        const double rho = largest_radius(method.name(), m, h, 80);
        BOOST_TEST(rho <= 1 + 1e-9, method.name() << ", " << text(m) << ": rho - 1 = " << rho - 1 << " at "
                                                  << h / limit << " of the limit");
      }
      if (limit == inf) continue;
      ++limited;
      const double above = largest_radius(method.name(), m, limit * (1 + 1e-4), 3000);
      BOOST_TEST(above > 1 + 1e-9, method.name() << ", " << text(m) << ": stable above the limit " << limit);
    }
    BOOST_TEST((limited > 20) != region.constants().covers_quadrant, method.name() << ": " << limited);
  }
}

// What is stable again further out does not count: the first exit does. Here across RK4's notch.
BOOST_AUTO_TEST_CASE(a_gap_ends_what_is_stable) {
  const StabilityRegion& region = region_of("rk4");
  int gaps = 0;
  for (const double y0 : {2.0, 7.5, 7.8, 8.0})
    for (const double slope : {-0.03, -0.01, 0.01, 0.03, 0.1}) {
      const double spacing = 1e-3;
      std::vector<double> x, y;
      for (int i = 0; i < 6000; ++i) {
        x.push_back(0.6 + (i + 0.5) * spacing);
        y.push_back(y0 + slope * (i + 0.5) * spacing);
      }
      std::vector<double> rho(x.size());
      spectral_radius("rk4", x, y, rho);
      const auto first = std::find_if(rho.begin(), rho.end(), [](double r) { return r > 1; });
      BOOST_TEST_REQUIRE((first != rho.begin() && first != rho.end()));
      gaps += std::any_of(first, rho.end(), [](double r) { return r < 1; });
      const double exit = region.first_exit({{{0.6, 1}}, {{y0, slope}}}),
                   expected = x[first - rho.begin()] - 0.6;
      BOOST_TEST(exit <= expected, "from Y = " << y0 << ", slope " << slope);
      BOOST_TEST(exit >= expected - spacing, "from Y = " << y0 << ", slope " << slope);
    }
  BOOST_TEST(gaps > 3);
  BOOST_TEST(gaps < 15);
}

// Explicit Euler's region is the triangle 0 < Y < X, Y > 2X - 4. With X = 1 + t/2 and X - Y = (t - ½)²/5 the
// curve touches a side, turns back, and leaves through the other where t²/5 + 3t/10 = 59/20.
BOOST_AUTO_TEST_CASE(a_curve_that_touches_the_boundary_goes_on) {
  const Curve curve{{{1, 0.5}}, {{1 - 0.05, 0.5 + 0.2, -0.2}}};
  BOOST_TEST(curve.y(0.5) == curve.x(0.5));
  const double exit = (-0.3 + std::sqrt(0.09 + 4 * 0.2 * 2.95)) / 0.4;
  BOOST_TEST(close(region_of("explicit-euler").first_exit(curve), exit, 1e-9));
}

BOOST_AUTO_TEST_CASE(limits_scale_exactly_with_the_unit_of_time, *boost::unit_test::label("slow")) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    for (const RayleighModes& m : random_modes(3, 4)) {
      const double limit = critical_step(region, m), recommended = recommended_step(region, m, 1.5);
      for (const double s : {1e9, 1e-9}) {  // times in units of s seconds
        const RayleighModes scaled{m.k_min * s * s, m.k_max * s * s, m.d0 * s, m.alpha / s};
        BOOST_TEST(close(critical_step(region, scaled) * s, limit, 1e-12),
                   method.name() << ", " << text(m) << ", s = " << s);
        BOOST_TEST(close(recommended_step(region, scaled, 1.5) * s, recommended, 1e-12),
                   method.name() << ", " << text(m) << ", s = " << s);
      }
    }
    for (const double d0 : {0.0, 0.4}) {
      const DampingDesign design = design_damping(region, 1, d0);
      for (const double s : {1e9, 1e-9}) {
        const DampingDesign scaled = design_damping(region, s * s, s * d0);
        BOOST_TEST(close(scaled.h_max * s, design.h_max, 1e-12), method.name()
                                                                     << ", d0 = " << d0 << ", s = " << s);
        // Where lines of several slopes do, the one chosen is known to less.
        if (std::isfinite(design.h_max))
          BOOST_TEST(std::abs(scaled.alpha * s - design.alpha) <= 1e-9 * design.h_max,
                     method.name() << ", d0 = " << d0 << ", s = " << s);
      }
      const double h = 0.8;
      BOOST_TEST(
          close(designed_alpha(region, h * 1e-9, d0 * 1e9) * 1e9, designed_alpha(region, h, d0), 1e-12),
          method.name() << ", d0 = " << d0);
    }
  }
}

BOOST_AUTO_TEST_CASE(without_d0_the_design_is_the_papers_rule) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    const RegionConstants& c = region.constants();
    const DampingDesign design = design_damping(region, 250, 0);
    if (!std::isfinite(c.y_max)) {
      BOOST_TEST(design.h_max == inf, method.name());
      continue;
    }
    BOOST_TEST(close(design.h_max, std::sqrt(c.y_max / 250), 1e-12), method.name());
    BOOST_TEST(std::abs(design.alpha - design.h_max * c.x_at_y_max / c.y_max) < 1e-12 * design.h_max,
               method.name());
  }
}

// Paper Eqs. 27, 31 while d0 <= √k0; beyond, h d0 < 2 (Eq. 32) is the limit.
BOOST_AUTO_TEST_CASE(design_for_explicit_euler) {
  const StabilityRegion& region = region_of("explicit-euler");
  const double omega = std::sqrt(250);
  for (const double ratio : {0.05, 0.3, 0.8, 0.99, 1.01, 1.5, 6.0}) {
    const double d0 = ratio * omega;
    const DampingDesign design = design_damping(region, 250, d0);
    BOOST_TEST(close(design.h_max, ratio < 1 ? 2 / omega : 2 / d0, 1e-9), "d0 = " << ratio << " √k0");
    if (ratio < 1)
      BOOST_TEST(close(design.alpha, design.h_max * (4 - design.h_max * d0) / 4, 1e-9),
                 "d0 = " << ratio << " √k0");
    // For a shorter step it is the line that reaches highest: to the corner (4, 4).
    const double h = 0.7 * design.h_max;
    BOOST_TEST(close(designed_alpha(region, h, d0), h * (4 - h * d0) / 4, 1e-9), "d0 = " << ratio << " √k0");
  }
}

BOOST_AUTO_TEST_CASE(design_for_symplectic_euler_adds_nothing) {
  for (const double d0 : {0.0, 0.3, 2.2}) {
    const DampingDesign design = design_damping(region_of("symplectic-euler"), 1, d0);
    BOOST_TEST(design.alpha == 0, "d0 = " << d0);
    const double h = design.h_max;
    BOOST_TEST(std::abs(h * h - (4 - 2 * h * d0)) < 1e-10, "d0 = " << d0);
  }
}

// theory 4i: the paper's formula up to d0 = 0.279 √k0, then alpha = 0, then the second apex, then the real
// interval.
BOOST_AUTO_TEST_CASE(design_for_rk4_goes_through_four_regimes) {
  const StabilityRegion& region = region_of("rk4");
  const RegionConstants& c = region.constants();
  for (const double d0 : {0.278}) {
    const DampingDesign design = design_damping(region, 1, d0);
    BOOST_TEST(close(design.h_max, std::sqrt(c.y_max), 1e-9), "d0 = " << d0);
    BOOST_TEST(close(design.alpha, design.h_max * (c.x_at_y_max - design.h_max * d0) / c.y_max, 1e-6),
               "d0 = " << d0);
  }
  for (const double d0 : {0.2805}) {
    const DampingDesign design = design_damping(region, 1, d0);
    BOOST_TEST(design.alpha == 0, "d0 = " << d0);
    BOOST_TEST(design.h_max < std::sqrt(c.y_max), "d0 = " << d0);
    BOOST_TEST(close(design.h_max, critical_step(region, {.k_max = 1, .d0 = d0}), 1e-9), "d0 = " << d0);
  }
  for (const double d0 : {0.7, 0.9}) {
    const DampingDesign design = design_damping(region, 1, d0);
    BOOST_TEST(close(design.h_max, std::sqrt(8.14384344942), 1e-6),
               "d0 = " << d0 << ": h = " << design.h_max);
    BOOST_TEST(close(design.h_max * d0 + design.alpha / design.h_max * 8.14384344942, 5.2192, 1e-3),
               "d0 = " << d0);
  }
  for (const double d0 : {1.0}) {
    const DampingDesign design = design_damping(region, 1, d0);
    BOOST_TEST(close(design.h_max, c.real_interval / d0, 1e-9), "d0 = " << d0 << ": h = " << design.h_max);
  }
}

BOOST_AUTO_TEST_CASE(the_designed_line_is_neutral_or_stable_and_no_line_of_a_longer_step_is) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    for (const double d0 : {0.0, 0.26, 0.61, 0.97}) {
      const DampingDesign design = design_damping(region, 1, d0);
      if (design.h_max == inf) {
        BOOST_TEST(region.constants().covers_quadrant, method.name());
        continue;
      }
      BOOST_TEST(design.h_max > 0, method.name() << ", d0 = " << d0);
      BOOST_TEST(design.alpha >= 0, method.name() << ", d0 = " << d0);
      const double rho = radius_of_design(method.name(), design, 1, d0);
      BOOST_TEST(rho <= 1 + 1e-9, method.name() << ", d0 = " << d0 << ": rho - 1 = " << rho - 1);
      for (const double longer : {1.001, 1.03, 1.2})
        BOOST_TEST(
            !some_alpha_works(method.name(), longer * design.h_max, d0),
            method.name() << ", d0 = " << d0 << ": " << longer << " times the designed step is possible");
      BOOST_TEST(some_alpha_works(method.name(), 0.97 * design.h_max, d0), method.name() << ", d0 = " << d0);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_recommended_step_is_the_smallest_of_four) {
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = region_of(method.name());
    bool each[4] = {};
    for (const RayleighModes& m : random_modes(6, 5)) {
      const double f = 1.5;
      const RayleighModes same_damping{f * m.k_min, f * m.k_max, m.d0, m.alpha / f};
      const RayleighModes same_alpha{f * m.k_min, f * m.k_max, m.d0, m.alpha};
      const RayleighModes faster{f * m.k_min, f * m.k_max, std::sqrt(f) * m.d0, m.alpha / std::sqrt(f)};
      const double limits[] = {critical_step(region, m), critical_step(region, same_damping),
                               critical_step(region, same_alpha), critical_step(region, faster)};
      const double smallest = *std::min_element(std::begin(limits), std::end(limits));
      BOOST_TEST(close(recommended_step(region, m, f), smallest, 1e-9), method.name() << ", " << text(m));
      for (int i = 0; i < 4; ++i) each[i] = each[i] || (limits[i] == smallest && limits[i] < inf);
      BOOST_TEST(close(recommended_step(region, m, 1), limits[0], 1e-12), method.name() << ", " << text(m));
    }
    if (region.constants().covers_quadrant) continue;
    BOOST_TEST((each[2] && each[3]), method.name());
    // Where the limit falls as damping grows, √F·D beside F·K never leaves more than D does.
    BOOST_TEST(each[1] == !region.exact_condition().has_value(), method.name());
  }
  // Undamped, dividing by √F is right; with fixed damping explicit Euler loses F, not √F.
  const double f = 1.5;
  BOOST_TEST(
      close(recommended_step(region_of("symplectic-euler"), {.k_max = 9}, f), 2 / std::sqrt(9 * f), 1e-12));
  BOOST_TEST(recommended_step(region_of("explicit-euler"), {.k_max = 9}, f) == 0);
  const RayleighModes one{.k_min = 900, .k_max = 900, .d0 = 3};
  const double kept =
      recommended_step(region_of("explicit-euler"), one, f) / critical_step(region_of("explicit-euler"), one);
  BOOST_TEST(close(kept, 1 / f, 1e-12));
  // More stiffness raises an overdamped limit, which is no reason to take a longer step, nor to leave no
  // margin.
  const RayleighModes overdamped{.k_min = 1, .k_max = 1, .d0 = 4};
  const RayleighModes stiffer{.k_min = f, .k_max = f, .d0 = 4};
  const StabilityRegion& rk4 = region_of("rk4");
  BOOST_TEST(critical_step(rk4, stiffer) > critical_step(rk4, overdamped));
  BOOST_TEST(recommended_step(rk4, overdamped, f) == critical_step(rk4, overdamped) / std::sqrt(f));
}

// Of a mode with k < 0 one motion grows by itself, e^{μt} with μ > 0, and one decays: the step's matrix has
// no more than one eigenvalue outside the unit circle up to H, and two beyond. Where eigenvalues are R(hμ)
// the decaying motion has the limit of an overdamped mode of that rate.
BOOST_AUTO_TEST_CASE(the_decaying_motion_of_a_mode_that_grows_counts) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> decades(-3, 3), uniform(-1, 1);
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = springstab::stability_region(method);
    const auto outside = [&](double k, double d, double h) {
      const Eigen::MatrixXd a = method.amplification(h * d, h * h * k);
      const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(a, false).eigenvalues();
      return (values.cwiseAbs().array() > 1 + 1e-12).count();
    };
    for (int i = 0; i < 100; ++i) {
      const double k = -std::pow(10, decades(random));
      // Where negative damping dominates the matrix of a step holds nothing of the slow motion but rounding.
      const double sign = uniform(random),
                   d = sign < 0 ? 3 * sign * std::sqrt(-k) : std::pow(10, decades(random));
      const double h = region.critical_step_beside_growth(k, d);
      BOOST_TEST_CONTEXT(method.name() << ", k = " << k << ", d = " << d) {
        const double root = std::hypot(d, 2 * std::sqrt(-k)),
                     mu = d > 0 ? (d + root) / 2 : -2 * k / (root - d);
        if (method.name() != "symplectic-euler")
          BOOST_TEST(close(h, region.critical_step(mu * mu, 2 * mu), 1e-9));
        const double end = std::isfinite(h) ? 0.9999 * h : 1e3 / mu;
        for (int j = 1; j <= 50; ++j) BOOST_TEST(outside(k, d, end * j / 50) <= 1);
        if (std::isfinite(h)) BOOST_TEST(outside(k, d, 1.0001 * h) == 2);
        const RayleighModes line{.k_max = 1e-9, .k_lowest = k}, both{.k_max = 2, .k_lowest = k};
        BOOST_TEST(critical_step(region, both) <= critical_step(region, line));
      }
    }
    BOOST_TEST(region.critical_step_beside_growth(3, -0.1) == inf);
    BOOST_CHECK_THROW(region.critical_step_beside_growth(3, 0.1), std::invalid_argument);
    BOOST_CHECK_THROW(critical_step(region, {.k_max = 1, .k_lowest = 1}), std::invalid_argument);
  }
  // λ = -1 at 2X + Y = 4; of an undamped mode the decaying motion never leaves.
  const StabilityRegion& symplectic = region_of("symplectic-euler");
  BOOST_TEST(symplectic.critical_step_beside_growth(-1, 0) == inf);
  BOOST_TEST(close(symplectic.critical_step_beside_growth(-1, 3), 3 - std::sqrt(5.0), 1e-12));
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused) {
  const StabilityRegion& region = region_of("rk4");
  for (const double bad : {-1.0, -1e-300, double{NAN}, inf, -inf}) {
    const RayleighModes good{.k_min = 1, .k_max = 2, .d0 = 1, .alpha = 1};
    for (double RayleighModes::*member :
         {&RayleighModes::k_min, &RayleighModes::k_max, &RayleighModes::d0, &RayleighModes::alpha}) {
      RayleighModes modes = good;
      modes.*member = bad;
      BOOST_CHECK_THROW(critical_step(region, modes), std::invalid_argument);
      BOOST_CHECK_THROW(recommended_step(region, modes, 1.5), std::invalid_argument);
    }
    BOOST_CHECK_THROW(design_damping(region, bad, 0), std::invalid_argument);
    BOOST_CHECK_THROW(design_damping(region, 1, bad), std::invalid_argument);
    BOOST_CHECK_THROW(recommended_step(region, good, bad), std::invalid_argument);
  }
  BOOST_CHECK_THROW(critical_step(region, {.k_min = 3, .k_max = 2}), std::invalid_argument);
  BOOST_CHECK_THROW(recommended_step(region, {.k_max = 2}, 0.99), std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
