// `springstab figures`: computes what each figure shows, writes it as CSV, and has gnuplot draw it.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "experiments/experiments.h"
#include "experiments/output.h"
#include "experiments/region.h"
#include "solvers/io/input_error.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

namespace fs = std::filesystem;

struct RegionFigure {
  std::string file;    // without suffix
  std::string number;  // in the paper, or empty
  std::string method;
};

// The paper numbers three methods; every other one has its region drawn in the same style.
std::vector<RegionFigure> region_figures() {
  const std::vector<std::pair<std::string_view, std::string>> numbered{
      {"explicit-euler", "1"}, {"rk4", "2"}, {"implicit-euler", "3"}};
  std::vector<RegionFigure> figures;
  for (const MethodInfo& info : all_methods()) {
    if (info.linearized) continue;  // the region of the method inside
    RegionFigure figure{"region_" + std::string(info.name), "", std::string(info.name)};
    for (const auto& [method, number] : numbered)
      if (method == info.name)
        figure = {"figure_" + number + "_" + std::string(info.name), number, figure.method};
    figures.push_back(figure);
  }
  return figures;
}

// Whether stability reaches where the motion itself grows (X < 0 or Y < 0), and the middle of a piece that
// lies below Y = 0 altogether, for its name.
struct OverStable {
  bool exists = false;
  double x = 0, y = 0;
};

OverStable over_stable_part(const std::vector<RegionPiece>& pieces) {
  OverStable found;
  double area = 0;
  for (const RegionPiece& piece : pieces) {
    found.exists = found.exists || piece.x.front() < -1e-6;
    if (*std::max_element(piece.y_upper.begin(), piece.y_upper.end()) > 1e-6) continue;
    found.exists = true;
    for (std::size_t i = 1; i < piece.x.size(); ++i) {
      const double strip = (piece.x[i] - piece.x[i - 1]) * (piece.y_upper[i] - piece.y_lower[i]);
      area += strip;
      found.x += strip * piece.x[i];
      found.y += strip * (piece.y_upper[i] + piece.y_lower[i]) / 2;
    }
  }
  if (area > 0) found.x /= area, found.y /= area;
  return found;
}

// gnuplot's string literal.
std::string literal(const std::string& s) {
  std::string quoted = "'";
  for (char c : s) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

void run_gnuplot(const std::string& settings, const std::string& script) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("cannot start gnuplot: ") + std::strerror(errno));
  if (child == 0) {
    dup2(STDERR_FILENO, STDOUT_FILENO);  // stdout belongs to the report
    execlp("gnuplot", "gnuplot", "-e", settings.c_str(), script.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
      throw InputError("gnuplot", 0, "was not found, expected it to be installed (gnuplot-nox)");
    throw std::runtime_error("gnuplot failed on " + script);
  }
}

// Draws aside and moves the pictures into place, so that no figure is ever half-written.
Json draw_region(const RegionFigure& figure, const CommonOptions& common, const FiguresOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const StabilityRegion& region = stability_region(figure.method);
  const RegionConstants& c = region.constants();
  const Window window = region.natural_window(0.15);
  const std::string base = options.output + "/" + figure.file;
  write_boundary(base + "_boundary.csv", region, window);
  write_pieces(base + "_pieces.csv", region, window);
  const int side = options.quick ? 24 : 56;
  const CellComparison cells = compare_cells(figure.method, {window, side, side}, options.quick ? 500 : 4000,
                                             common.threads, base + "_cells.csv");

  std::string settings = text(
      "x_min=%.9g; x_max=%.9g; y_min=%.9g; y_max=%.9g; cells=%ld; steps=%ld; differ=%ld; "
      "outside=%ld; band=%.3g; ",
      window.x_min, window.x_max, window.y_min, window.y_max, cells.cells, cells.steps, cells.disagreements,
      cells.outside_band, cells.band);
  // The damping line is drawn for an air drag h·d0 of a tenth of the apex's X, so that its start is seen
  // apart from 0.
  const bool bounded = std::isfinite(c.y_max);
  const double line_x = bounded ? 0.1 * c.x_at_y_max : 0;
  const bool has_line = bounded && line_x > 1e-6 && region.damping_line(line_x).reach == c.y_max;
  settings += text("bounded=%d; apex_x=%.9g; apex_y=%.9g; has_line=%d; line_x=%.9g; ", bounded,
                   bounded ? c.x_at_y_max : 0, bounded ? c.y_max : 0, has_line, line_x);
  const OverStable over = over_stable_part(region.pieces(window));
  settings += text("has_over=%d; over_x=%.9g; over_y=%.9g; ", over.exists, over.x, over.y);
  settings += "method=" + literal(std::string(find_method(figure.method).title)) +
              "; number=" + literal(figure.number) + "; data=" + literal(base) + "; ";
  std::vector<std::string> files;
  for (const char* type : {"svg", "png"}) {
    const std::string aside = base + ".part." + type, target = base + "." + type;
    run_gnuplot(settings + "type=" + literal(type) + "; output_file=" + literal(aside),
                options.plots + "/region.gp");
    fs::rename(aside, target);
    files.push_back(target);
  }
  for (const char* part : {"_boundary.csv", "_pieces.csv", "_cells.csv"}) files.push_back(base + part);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {{"name", figure.file},
          {"files", files},
          {"seconds", seconds.count()},
          {"cells", cells.cells},
          {"disagreements", cells.disagreements},
          {"band", cells.band},
          {"outside_band", cells.outside_band}};
}

}  // namespace

int run_figures(const CommonOptions& common, const FiguresOptions& options) {
  std::vector<RegionFigure> wanted;
  const std::vector<RegionFigure> all = region_figures();
  for (const std::string& name : options.names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const RegionFigure& f) {
      return name == f.number || name == f.method || name == f.file;
    });
    if (found == all.end()) {
      std::string known;
      for (const RegionFigure& f : all)
        known += (known.empty() ? "" : ", ") + (f.number.empty() ? f.method : f.number);
      throw InputError("figures", 0, "there is no figure '" + name + "', expected one of " + known);
    }
    wanted.push_back(*found);
  }
  if (wanted.empty()) wanted = all;
  if (!fs::is_regular_file(options.plots + "/region.gp"))
    throw InputError(options.plots, 0,
                     "has no region.gp, expected the folder of the gnuplot scripts (--plots)");
  make_folder(options.output);

  Json list = Json::array();
  bool agreed = true;
  for (const RegionFigure& figure : wanted) {
    list.push_back(draw_region(figure, common, options));
    const Json& last = list.back();
    agreed = agreed && last["outside_band"] == 0;
    if (!common.quiet)
      std::cerr << text(
          "%s: %.2f s, %ld simulated cells, %ld differ from theory, %ld of them outside the band\n",
          figure.file.c_str(), last["seconds"].get<double>(), last["cells"].get<long>(),
          last["disagreements"].get<long>(), last["outside_band"].get<long>());
  }
  if (common.json) std::cout << Json{{"figures", list}}.dump(2) << '\n';
  return agreed ? done : no_answer;
}

}  // namespace springstab
