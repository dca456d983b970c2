// The map of a cloth whose damping does not commute with its stiffness: a method's region, how far the joint
// numerical range W of the cloth's matrices reaches in it, and where its eigenpairs lie, at a step below the
// limit and at one above.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/method.h"
#include "analysis/regions/amplification.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/structure_limits.h"
#include "experiments/inputs/subject.h"
#include "experiments/region.h"
#include "experiments/studies/divergence/divergence.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

constexpr const char* map_methods[] = {"explicit-euler", "rk4"};
constexpr double above_limit = 1.05;  // of the limit
constexpr long map_steps = 20000;

// A flat net at rest, its three kinds of springs damped in other proportions than they are stiff.
Subject damped_net() {
  SceneDescription scene;
  scene.geometry = Grid{8, 8};
  scene.material = SpringMaterial{.particle_mass = 1.25e-4, .damping = {0.12, 0.025, 0.005}};
  scene.pins.kind = Pins::Kind::first_row;
  return Subject(scene);
}

// The boundary of W from within, counter-clockwise: its extreme points in equally many directions of the
// (X, Y) plane at the step h.
std::vector<ModePoint> outline(const StructuralMatrices& s, double h) {
  constexpr int directions = 180;
  const NumericalRange range(s);
  std::vector<ModePoint> points;
  for (int i = 0; i < directions; ++i) {
    const double angle = 2 * std::numbers::pi * i / directions;
    if (const auto point = range.farthest(h * std::cos(angle), h * h * std::sin(angle)))
      points.push_back(*point);
  }
  return points;
}

bool run_diverges(const StructuralMatrices& s, const std::string& method, double h, std::uint64_t seed) {
  MatrixSystem system(s);
  State<Vector> state{Vector(s.size()), Vector::Zero(s.size())};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (double& x : state.x) x = uniform(random);
  const EnergyWatch watch{.initial_energy = system.potential_energy(state.x)};
  return simulate(system, *Method(method).stepper(), {h, map_steps}, watch, state).status != StepStatus::done;
}

/// One panel of the figure.
struct Panel {
  std::string method;
  double h, ratio;  // ratio: of the limit
  long outside = 0;
  bool diverged = false;
};

Panel draw_panel(const std::string& base, const StructuralMatrices& s, const std::vector<DampedMode>& modes,
                 Panel panel, std::uint64_t seed) {
  std::vector<double> x, y, radii(modes.size());
  for (const DampedMode& mode : modes) {
    x.push_back(panel.h * mode.d);
    y.push_back(panel.h * panel.h * mode.k);
  }
  spectral_radius(panel.method, x, y, radii);
  OutputFile points(base + "_modes.csv");
  points.stream() << "x,y,spectral_radius\n";
  for (std::size_t i = 0; i < modes.size(); ++i)
    points.stream() << x[i] << ',' << y[i] << ',' << radii[i] << '\n';
  points.commit();
  OutputFile edge(base + "_outline.csv");
  edge.stream() << "x,y\n";
  for (const ModePoint& p : outline(s, panel.h))
    edge.stream() << panel.h * p.d << ',' << panel.h * panel.h * p.k << '\n';
  edge.commit();
  panel.outside = std::count_if(radii.begin(), radii.end(), [](double r) { return !(r <= 1); });
  panel.diverged = run_diverges(s, panel.method, panel.h, seed);
  return panel;
}

Json draw_map(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  Subject subject = damped_net();
  StructureLimits answer(subject.structure(subject.initial_state(common.seed)),
                         {.safety = 1, .seed = common.seed});
  const StructuralMatrices& s = answer.structure().matrices;
  const std::vector<DampedMode> modes = damped_modes(s).value();

  std::string settings = "data=" + gnuplot_literal(files.data) + text("; steps=%ld; ", map_steps);
  std::vector<std::string> written;
  bool holds = true;
  for (const std::string method : map_methods) {
    const MethodLimits limits = answer.limits(method);
    const double limit = limits.h_max.value();
    const StabilityRegion& region = stability_region(method);
    const Window window = region.natural_window(0.1);
    std::string name = method;
    std::replace(name.begin(), name.end(), '-', '_');
    settings += text("%s_window=\"%.9g %.9g %.9g %.9g\"; ", name.c_str(), window.x_min, window.x_max,
                     window.y_min, window.y_max);
    write_boundary(files.data + "_" + method + "_boundary.csv", region, window);
    write_pieces(files.data + "_" + method + "_pieces.csv", region, window);
    for (const char* part : {"_boundary.csv", "_pieces.csv"})
      written.push_back(files.data + "_" + method + part);
    for (const bool stable : {true, false}) {
      const double h = stable ? limits.h_certified.value_or(0.95 * limit) : above_limit * limit;
      const std::string file = "_" + method + (stable ? "_below" : "_above");
      const Panel panel = draw_panel(files.data + file, s, modes, {method, h, h / limit}, common.seed);
      holds = holds && panel.diverged == !stable && (panel.outside > 0) == !stable;
      settings += text("%s_%s=\"%.6g %.6g %ld %d\"; ", name.c_str(), stable ? "below" : "above", h,
                       panel.ratio, panel.outside, panel.diverged);
      for (const char* part : {"_modes.csv", "_outline.csv"}) written.push_back(files.data + file + part);
    }
  }
  const std::vector<std::string> drawn = draw(options.plots + "/divergence_map.gp", settings, files.picture);
  written.insert(written.end(), drawn.begin(), drawn.end());
  return {{"files", written},
          {"holds", holds},
          {"summary", text("%zu eigenpairs of a damped net, below and above the limits of %zu methods",
                           modes.size(), std::size(map_methods))}};
}

}  // namespace

Figure divergence_map() { return {.file = "divergence_map", .name = "divergence-map", .draw = draw_map}; }

}  // namespace springstab
