// The stable region of each method as a figure: exact boundary, filled pieces, and cells that were simulated.
#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/method.h"
#include "experiments/region.h"
#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

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

Json draw_region(const std::string& method, const std::string& number, const FigureFiles& files,
                 const CommonOptions& common, const FiguresOptions& options) {
  const StabilityRegion& region = stability_region(method);
  const RegionConstants& c = region.constants();
  const Window window = region.natural_window(0.15);
  write_boundary(files.data + "_boundary.csv", region, window);
  write_pieces(files.data + "_pieces.csv", region, window);
  const int side = options.quick ? 24 : 56;
  const CellComparison cells = compare_cells(method, {window, side, side}, options.quick ? 500 : 4000,
                                             common.threads, files.data + "_cells.csv");

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
  settings += "method=" + gnuplot_literal(Method(method).info().title) +
              "; number=" + gnuplot_literal(number) + "; data=" + gnuplot_literal(files.data) + "; ";
  std::vector<std::string> written = draw(options.plots + "/region.gp", settings, files.picture);
  for (const char* part : {"_boundary.csv", "_pieces.csv", "_cells.csv"})
    written.push_back(files.data + part);
  return {{"files", written},
          {"holds", cells.outside_band == 0},
          {"summary", text("%ld simulated cells, %ld differ from theory, %ld of them outside the band",
                           cells.cells, cells.disagreements, cells.outside_band)},
          {"cells", cells.cells},
          {"disagreements", cells.disagreements},
          {"band", cells.band},
          {"outside_band", cells.outside_band}};
}

}  // namespace

// The paper numbers three methods.
Figure region_figure(const std::string& method) {
  const std::map<std::string_view, std::string> numbered{
      {"explicit-euler", "1"}, {"rk4", "2"}, {"implicit-euler", "3"}};
  const auto found = numbered.find(Method(method).name());
  const std::string number = found == numbered.end() ? "" : found->second;
  const auto draw_it = [method, number](const FigureFiles& files, const CommonOptions& common,
                                        const FiguresOptions& options) {
    return draw_region(method, number, files, common, options);
  };
  if (number.empty()) return {.file = "region_" + method, .name = method, .draw = draw_it};
  return {.file = "figure_" + number + "_" + method, .name = number, .alias = method, .draw = draw_it};
}

std::vector<Figure> region_figures() {
  std::vector<Figure> figures;
  for (const auto* list : {&all_methods(), &added_methods()})
    for (const Method& each : *list)
      if (!each.info().linearized) figures.push_back(region_figure(each.name()));  // else of the one inside
  return figures;
}

}  // namespace springstab
