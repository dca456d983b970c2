// Where simulations disagree with the stable regions, and where cloth leaves its predicted limits, as
// pictures.
#include <algorithm>
#include <filesystem>

#include "experiments/region.h"
#include "experiments/studies/divergence/divergence.h"
#include "experiments/studies/figure_list.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {
namespace {

Json draw_divergence(const FigureFiles& files, const CommonOptions& common, const FiguresOptions& options) {
  DivergenceOptions study;
  study.quick = options.quick;
  if (options.quick) study.cells = 100, study.steps = 500;
  study.output = std::filesystem::path(files.data).parent_path().string();
  const Json report = divergence(common, study);

  std::string settings =
      "data=" + gnuplot_literal(files.data) + text("; cells=%d; steps=%ld; ", study.cells, study.steps);
  std::vector<std::string> written;
  for (const Json& row : report["plane"]) {
    const std::string method = row["method"];
    const Window window = stability_region(method).natural_window(0.15);
    const std::string boundary = files.data + "_" + method + "_boundary.csv";
    write_boundary(boundary, stability_region(method), window);
    std::string name = method;
    std::replace(name.begin(), name.end(), '-', '_');
    settings += text("%s=\"%.9g %.9g %.9g %.9g %ld %.3g %ld\"; ", name.c_str(), window.x_min, window.x_max,
                     window.y_min, window.y_max, row["disagreements"].get<long>(), row["band"].get<double>(),
                     row["outside_band"].get<long>());
    written.push_back(boundary);
    written.push_back(files.data + "_" + method + ".csv");
  }
  settings += text("duration=%g; linear_steps=%ld; ", report["duration"].get<double>(),
                   report["linear_steps"].get<long>());
  const Json& pendulum = report["pendulum"];
  settings += text("pendulum_step=%.6g; ", pendulum["step"].get<double>());
  for (const char* part : {"cloth", "safety", "pendulum"})
    written.push_back(files.data + "_" + part + ".csv");
  for (const char* picture : {"plane", "cloth"}) {
    const std::vector<std::string> drawn =
        draw(options.plots + "/divergence_" + picture + ".gp", settings, files.picture + "_" + picture);
    written.insert(written.end(), drawn.begin(), drawn.end());
  }
  const bool holds = report["outside_band"] == 0 && report["linear_outside_band"] == 0;
  return {
      {"files", written},
      {"holds", holds},
      {"summary",
       text("%ld cells and %ld runs of linear systems, %ld and %ld of them against theory outside the band",
            report["cells"].get<long>(), report["linear_runs"].get<long>(),
            report["outside_band"].get<long>(), report["linear_outside_band"].get<long>())}};
}

}  // namespace

std::vector<Figure> divergence_figures() {
  return {{.file = "divergence", .name = "divergence", .draw = draw_divergence}, divergence_map()};
}

}  // namespace springstab
