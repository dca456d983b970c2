// Contact as pictures: the share of runs that diverge below the limit without contact, by the rule of the
// impulses, and frames of the scenes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/limits/step_policy.h"
#include "experiments/inputs/subject.h"
#include "experiments/studies/contact/contact_study.h"
#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"
#include "experiments/studies/parallel.h"
#include "solvers/contact/contact_filter.h"

namespace springstab {
namespace {

constexpr double walled_parts[] = {0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.99, 0.999};
constexpr const char* walled_methods[] = {"symplectic-euler", "velocity-verlet", "rk4", "nystrom4"};

std::vector<WalledRuns> walled_table() {
  std::vector<WalledRuns> all;
  for (const char* structure : walled_structures)
    for (const char* method : walled_methods)
      for (const ContactModel& model : {ContactModel(LandingImpulses()), ContactModel(InelasticImpulses())})
        for (const double part : walled_parts) all.push_back({structure, method, model, part});
  return all;
}

const char* name_of(const ContactModel& model) {
  return std::holds_alternative<LandingImpulses>(model) ? "impulses" : "inelastic";
}

Json draw_walled(const std::string& base, const CommonOptions& common, const FiguresOptions& options) {
  std::vector<WalledRuns> table = walled_table();
  const int count = options.quick ? 12 : 60;
  const long steps = options.quick ? 500 : 3000;
  parallel_ranges(static_cast<long>(table.size()), 1, common.threads, [&](long first, long last) {
    for (long i = first; i < last; ++i) table[i] = run_between_walls(table[i], count, steps);
  });
  OutputFile file(base + ".csv");
  file.stream() << "structure,method,model,part,runs,diverged,largest_energy\n";
  int proved = 0, inelastic = 0, runs = 0;
  for (const WalledRuns& row : table) {
    file.stream() << row.structure << ',' << row.method.name() << ',' << name_of(row.model) << ','
                  << text("%g,%d,%d,%.6g\n", row.part, row.runs, row.diverged, row.largest_energy);
    const bool lands = std::holds_alternative<LandingImpulses>(row.model);
    if (lands && row.method.name() == "symplectic-euler") proved += row.diverged, runs += row.runs;
    if (!lands) inelastic += row.diverged;
  }
  file.commit();
  std::vector<std::string> files =
      draw(options.plots + "/contact.gp",
           "data=" + gnuplot_literal(base + ".csv") + text("; runs=%d; ", count), base);
  files.push_back(base + ".csv");
  return {
      {"files", files},
      {"holds", proved == 0 && inelastic > 0},
      {"summary", text("impulses that land, symplectic Euler: %d of %d runs diverge; inelastic impulses, all "
                       "methods: %d",
                       proved, runs, inelastic)}};
}

// A square sheet in a scene like those of experiments/scenes, and until when it is shown.
struct ShownScene {
  const char *title, *contact, *more;
  double duration;  // [s]
};
constexpr int shown_side = 32, shown_frames = 4;
constexpr ShownScene shown_scenes[] = {
    {"A sheet falls over a ball onto a floor",
     R"({"obstacles": [{"sphere": {"center": [0.39, -0.2, 0.39], "radius": 0.16}},
        {"plane": {"point": [0, -0.5, 0], "normal": [0, 1, 0]}}], "thickness": 0.006, "friction": 0.3})",
     R"("pins": "none")", 0.8},
    {"A ball rises under a sheet that hangs by its corners",
     R"({"obstacles": [{"sphere": {"center": [0.39, -0.6, 0.36], "radius": 0.15}, "velocity": [0, 0.7, 0]}],
        "thickness": 0.006, "friction": 0.2})",
     R"("pins": "corners")", 0.8},
    {"A sheet slides down a slope of 30° with a ball on it",
     R"({"obstacles": [{"plane": {"point": [0, -0.02, 0], "normal": [0.5, 0.866025, 0]}},
        {"sphere": {"center": [0.9, -0.56, 0.3], "radius": 0.12}}], "thickness": 0.006, "friction": 0.2})",
     R"("initial": {"velocity": [0.2, 0, 0]})", 0.9}};

using Positions = std::vector<Eigen::Vector3d>;

// Lines of x, z, y (up), a blank line after each row and two at the end.
void write_rows(std::ostream& out, const Positions& places, std::size_t columns) {
  for (std::size_t i = 0; i < places.size(); ++i)
    out << text("%.5g,%.5g,%.5g\n", places[i].x(), places[i].z(), places[i].y())
        << ((i + 1) % columns == 0 ? "\n" : "");
  out << '\n';
}

// A ball as rows of places, or a piece of a plane, of a slope twice as long as the cloth.
Positions surface_of(const Obstacle& obstacle, double t, const Positions& cloth) {
  constexpr int n = 24;
  Positions places;
  if (const auto* sphere = std::get_if<Sphere>(&obstacle.shape)) {
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const double a = std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n;
        places.push_back(sphere->center + t * obstacle.velocity +
                         sphere->radius * Eigen::Vector3d(std::sin(a) * std::cos(b), std::cos(a),
                                                          std::sin(a) * std::sin(b)));
      }
    return places;
  }
  const Plane& plane = std::get<Plane>(obstacle.shape);
  Eigen::Vector3d low = cloth[0], high = low;
  for (const Eigen::Vector3d& p : cloth) low = low.cwiseMin(p), high = high.cwiseMax(p);
  if (plane.normal.y() < 0.99) high.x() += high.x() - low.x();
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      Eigen::Vector3d p = low + Eigen::Vector3d(i, 0, j).cwiseProduct(high - low) / n;
      places.push_back(p - plane.normal.dot(p - plane.point - t * obstacle.velocity) / plane.normal.y() *
                               Eigen::Vector3d::UnitY());
    }
  return places;
}

// The frames of one scene: of each the cloth, then its obstacles. The lowest gap of a particle [m].
double write_frames(std::ostream& out, const ShownScene& shown, const std::string& method) {
  Subject subject(parse_scene("figures", text(R"({"geometry": {"grid": [%d, %d]}, "material": {"bending": 2},
        "damping": {"d0": 1, "alpha": 2e-4}, "contact": %s, %s})",
                                              shown_side, shown_side, shown.contact, shown.more)));
  const Contact& contact = *subject.contact();
  const State<Vector> start = subject.initial_state();
  StepChooser chooser(subject, {.method = method, .duration = shown.duration});
  const StepPlan plan = chooser.first_plan().value();
  const auto filter = subject.contact_filter();
  State<Vector> state = start;
  const Positions first = subject.scene()->positions(start.x);
  double lowest = 1;
  int written = 0;
  simulate(
      subject.system(), *chooser.method().stepper(), plan, with_obstacles(chooser.watch(start), contact),
      state,
      [&](const RunSoFar& run, const State<Vector>& now) {
        const Positions cloth = subject.scene()->positions(now.x);
        for (const Obstacle& obstacle : contact.obstacles)
          for (const Eigen::Vector3d& p : cloth)
            lowest = std::min(lowest, gap_at(obstacle, p, run.time).gap - contact.thickness);
        if (written == shown_frames || run.steps < plan.steps * written / (shown_frames - 1)) return true;
        write_rows(out, cloth, shown_side);
        for (const Obstacle& obstacle : contact.obstacles)
          write_rows(out, surface_of(obstacle, run.time, first), 25);
        ++written;
        return true;
      },
      {}, filter.get());
  return lowest;
}

Json draw_scenes(const std::string& base, const CommonOptions&, const FiguresOptions& options) {
  std::vector<std::string> files;
  double lowest = 1;
  std::string settings = text("frames=%d; ", shown_frames);
  OutputFile file(base + ".csv");
  for (const ShownScene& shown : shown_scenes)
    lowest = std::min(lowest, write_frames(file.stream(), shown, "symplectic-euler"));
  file.commit();
  for (std::size_t i = 0; i < std::size(shown_scenes); ++i)
    settings += text("title_%zu=", i) + gnuplot_literal(shown_scenes[i].title) +
                text("; duration_%zu=%g; ", i, shown_scenes[i].duration);
  files = draw(options.plots + "/contact_scenes.gp",
               "data=" + gnuplot_literal(base + ".csv") + "; " + settings, base);
  files.push_back(base + ".csv");
  return {
      {"files", files},
      {"holds", lowest > -1e-12},
      {"summary", text("at every step all particles keep the thickness, to %.2g m", std::max(-lowest, 0.))}};
}

}  // namespace

std::vector<Figure> contact_figures() {
  return {{.file = "contact_divergence", .name = "contact", .draw = draw_walled},
          {.file = "contact_scenes", .name = "contact-scenes", .draw = draw_scenes}};
}

}  // namespace springstab
