// `springstab figures`: has the figures that were asked for computed and drawn.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "experiments/command/interrupt.h"
#include "experiments/command/shared_options.h"
#include "experiments/studies/figure_list.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

std::vector<Figure> all_figures() {
  std::vector<Figure> all = region_figures();
  for (const auto& more : {drape_figures(), timing_figures(), divergence_figures(), contact_figures(),
                           precision_figures(), stress_figures()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::vector<Figure> chosen_figures(const std::vector<std::string>& names) {
  std::vector<Figure> all = all_figures();
  if (names.empty()) return all;
  std::vector<Figure> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Figure& f) {
      return name == f.name || name == f.file || (!f.alias.empty() && name == f.alias);
    });
    if (found == all.end()) {
      try {
        chosen.push_back(region_figure(name));
        continue;
      } catch (const UnknownMethod&) {
      }
      std::string known;
      for (const Figure& f : all) known += (known.empty() ? "" : ", ") + f.name;
      throw InputError("figures", 0, "there is no figure '" + name + "', expected one of " + known);
    }
    chosen.push_back(*found);
  }
  return chosen;
}

int run_figures(const CommonOptions& common, const FiguresOptions& options) {
  const std::vector<Figure> figures = chosen_figures(options.names);
  if (!std::filesystem::is_regular_file(options.plots + "/region.gp"))
    throw InputError(options.plots, 0,
                     "has no region.gp, expected the folder of the gnuplot scripts (--plots)");
  const std::string data = options.output + "/data";
  make_folder(data);

  Json list = Json::array();
  bool all_hold = true;
  for (const Figure& figure : figures) {
    const auto start = std::chrono::steady_clock::now();
    Json drawn = figure.draw({options.output + "/" + figure.file, data + "/" + figure.file}, common, options);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    all_hold = all_hold && drawn["holds"];
    if (!common.quiet)
      std::cerr << text("%s: %.2f s, %s\n", figure.file.c_str(), seconds.count(),
                        drawn["summary"].get<std::string>().c_str());
    Json row{{"name", figure.file}, {"files", drawn["files"]}, {"seconds", seconds.count()}};
    drawn.erase("files");
    row.update(drawn);
    list.push_back(std::move(row));
    exit_on_interrupt(text("%zu figures are in %s", list.size(), options.output.c_str()));
  }
  if (common.json) print_json(Json{{"figures", list}});
  return all_hold ? done : no_answer;
}

}  // namespace

Subcommand figures_command() {
  const auto o = std::make_shared<FiguresOptions>();
  return {
      .name = "figures",
      .title = "Computes and plots the figures (needs gnuplot)",
      .footer = "example: springstab figures 1 2 --output figures",
      .options = {Option("NAMES", &o->names,
                         "1 to 7 (the paper's), frames, k0, precision-linear and others, long-runs, "
                         "stress or any method's name, for its region "
                         "(default: all)")
                      .shown_as(""),
                  Option("--quick", &o->quick, "fewer simulated cells, smaller cloths"),
                  plots_option(o->plots),
                  Option("--output", &o->output, "folder for the figures; their data go into its folder data")
                      .shown_as("DIR")
                      .with_default()},
      .run = [o](const CommonOptions& common) { return run_figures(common, *o); }};
}

}  // namespace springstab
