// The draping cloth as a picture (the paper's Fig. 4), frames of it over time, and k0 along drapes.
#include <algorithm>
#include <cmath>

#include "experiments/inputs/subject.h"
#include "experiments/studies/complexity/k0_watch.h"
#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

constexpr double settled = 1, strip_duration = 0.4;  // [s]
constexpr int strip_frames = 5;                      // after the first

Pins corners_of_first_row(int side) {
  return {.kind = Pins::Kind::indices, .ranges = {{0, 0}, {side - 1, side - 1}}, .source = "drape"};
}

// The paper's cloth, held in its middle by a disc as by a round table, so that it folds.
Drape tablecloth(int side) {
  Drape drape{.side = side, .damping = {.d0 = 2, .alpha = std::nullopt}};
  drape.pins.kind = Pins::Kind::indices;
  const double middle = (side - 1) / 2., radius = 0.25 * side;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      if (std::hypot(i - middle, j - middle) <= radius)
        drape.pins.ranges.push_back({i * side + j, i * side + j});
  return drape;
}

// Rows of particles as lines of x, z, y (up), a blank line after each row and two after each moment.
void write_meshes(const std::string& path, const Drape& drape, const std::vector<Moment>& moments) {
  Subject subject(describe(drape));
  OutputFile file(path);
  std::ostream& out = file.stream();
  out.precision(6);
  for (const Moment& moment : moments) {
    const std::vector<Eigen::Vector3d> positions = subject.scene()->positions(moment.state.x);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      out << positions[i].x() << ',' << positions[i].z() << ',' << positions[i].y() << '\n';
      if ((i + 1) % static_cast<std::size_t>(drape.side) == 0) out << '\n';
    }
    out << '\n';
  }
  file.commit();
}

Json draw_meshes(const Drape& drape, const std::vector<Moment>& moments, const std::string& script,
                 const FigureFiles& files) {
  write_meshes(files.data + ".csv", drape, moments);
  std::string settings = "data=" + gnuplot_literal(files.data + ".csv") +
                         text("; side=%d; frames=%zu; ", drape.side, moments.size());
  for (std::size_t i = 0; i < moments.size(); ++i) settings += text("time_%zu=%.3f; ", i, moments[i].time);
  std::vector<std::string> written = draw(script, settings, files.picture);
  written.push_back(files.data + ".csv");
  return {{"files", written},
          {"holds", true},
          {"summary", text("%d×%d particles by linearized explicit Euler, to %.3g s", drape.side, drape.side,
                           moments.back().time)}};
}

Json draw_drape(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const Drape drape = tablecloth(options.quick ? 20 : 40);
  const auto moments = moments_of(drape, "linearized-explicit-euler", settled, 1, common);
  return draw_meshes(drape, {moments.back()}, options.plots + "/drape.gp", files);
}

Json draw_frames(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const Drape drape = tablecloth(20);
  const auto moments = moments_of(drape, "linearized-explicit-euler", strip_duration, strip_frames, common);
  return draw_meshes(drape, moments, options.plots + "/drape_frames.gp", files);
}

struct WatchedDrape {
  std::string name;
  Drape drape;
};

std::vector<WatchedDrape> watched_drapes(int side) {
  const Pins corners = corners_of_first_row(side);
  const SpringMaterial springs{.particle_mass = 1.25e-4};
  return {
      {"cloth by its first row", {.side = side}},
      {"cloth 100 times softer, by two corners", {.side = side, .stiffness_factor = 0.01, .pins = corners}},
      {"cloth 300 times softer, by two corners",
       {.side = side, .stiffness_factor = 1. / 300, .pins = corners}},
      {"springs, by the first row", {.side = side, .material = springs}},
      {"springs 100 times softer, by two corners",
       {.side = side, .stiffness_factor = 0.01, .material = springs, .pins = corners}}};
}

void write_samples(std::ostream& out, const std::string& name, const std::vector<K0Sample>& samples) {
  out << "# " << name << "\n# time,k0,ratio,stretch";
  for (const char* search : k0_search_names)
    out << ',' << search << "_products," << search << "_error," << search << "_converged";
  out << '\n';
  for (const K0Sample& sample : samples) {
    out << sample.time << ',' << sample.k0 << ',' << sample.k0 / samples.front().k0 << ',' << sample.stretch;
    for (const K0Search& search : sample.searches)
      out << ',' << search.products << ',' << sample.error(search) << ',' << search.converged;
    out << '\n';
  }
  out << "\n\n";
}

// Totals over the samples after the first, where warm starts are warm.
Json totals(const std::string& name, const std::vector<K0Sample>& samples) {
  Json row{{"drape", name}, {"searches", samples.size() - 1}};
  double highest = 0, stretch = 0;
  for (const K0Sample& sample : samples) {
    highest = std::max(highest, sample.k0 / samples.front().k0);
    stretch = std::max(stretch, sample.stretch);
  }
  row["largest_ratio"] = number(highest);
  row["largest_stretch"] = number(stretch);
  for (std::size_t way = 0; way < k0_search_names.size(); ++way) {
    long products = 0;
    double seconds = 0, error = 0;
    bool converged = true;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const K0Search& search = samples[i].searches[way];
      products += search.products;
      seconds += search.cpu_seconds;
      error = std::max(error, std::abs(samples[i].error(search)));
      converged = converged && search.converged;
    }
    row[k0_search_names[way]] = {{"products", products},
                                 {"cpu_seconds", number(seconds)},
                                 {"largest_error", number(error)},
                                 {"converged", converged}};
  }
  return row;
}

// A ratio above the safety factor is a result, shown as such: the watch for divergence is there for it.
Json draw_k0(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  const std::vector<WatchedDrape> drapes = watched_drapes(options.quick ? 10 : 16);
  OutputFile file(files.data + ".csv");
  Json rows = Json::array();
  bool converged = true;
  double highest = 0;
  std::string settings =
      "data=" + gnuplot_literal(files.data + ".csv") + text("; drapes=%zu; ", drapes.size());
  for (std::size_t i = 0; i < drapes.size(); ++i) {
    const auto moments = moments_of(drapes[i].drape, "symplectic-euler", 1, options.quick ? 10 : 50, common);
    const std::vector<K0Sample> samples = watch_k0(drapes[i].drape, moments, 1e-3, common);
    write_samples(file.stream(), drapes[i].name, samples);
    rows.push_back(totals(drapes[i].name, samples));
    for (const char* search : k0_search_names) converged = converged && rows.back()[search]["converged"];
    highest = std::max(highest, rows.back()["largest_ratio"].get<double>());
    settings += text("name_%zu=", i + 1) +
                gnuplot_literal(drapes[i].name + text(": edges up to %.2f times their length",
                                                      rows.back()["largest_stretch"].get<double>())) +
                "; ";
  }
  file.commit();
  std::vector<std::string> written = draw(options.plots + "/k0.gp", settings, files.picture);
  written.push_back(files.data + ".csv");
  return {{"files", written},
          {"holds", converged},
          {"summary", text("k0 rises to at most %.4g times its value at the start", highest)},
          {"drapes", rows}};
}

}  // namespace

std::vector<Figure> drape_figures() {
  return {{.file = "figure_4_drape", .name = "4", .draw = draw_drape},
          {.file = "drape_frames", .name = "frames", .draw = draw_frames},
          {.file = "k0_during_drapes", .name = "k0", .draw = draw_k0}};
}

}  // namespace springstab
