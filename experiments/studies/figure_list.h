// The figures that `springstab figures` makes: each says what it is called and how it is drawn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/studies/gnuplot.h"

namespace springstab {

struct FiguresOptions {
  std::vector<std::string> names;  // empty for all
  bool quick = false;
  std::string plots, output = "paper_figures";  // folders
};

/// A figure. `draw` computes its data, writes them and plots; it returns what the report tells: "files",
/// "holds" (whether what the figure claims came out; a bool), "summary" (one line).
struct Figure {
  std::string file;     // without folder and suffix
  std::string name;     // on the command line
  std::string alias{};  // another name, or empty
  std::function<Json(const FigureFiles&, const CommonOptions&, const FiguresOptions&)> draw;
};

std::vector<Figure> region_figures();
/// The region of any method, in the same style. Throws UnknownMethod.
Figure region_figure(const std::string& method);
std::vector<Figure> drape_figures();   // the paper's Fig. 4, frames over time, k0 over time
std::vector<Figure> timing_figures();  // its Figs. 5 to 7
std::vector<Figure> divergence_figures();
std::vector<Figure> contact_figures();    // divergence in contact, and by penalties
std::vector<Figure> precision_figures();  // error against run time, long runs
std::vector<Figure> stress_figures();

}  // namespace springstab
