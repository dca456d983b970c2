// Theory against simulation, as data: what `springstab divergence` prints and its figures draw.
#pragma once

#include "analysis/method.h"
#include "experiments/studies/figure_list.h"

namespace springstab {

struct DivergenceOptions {
  std::vector<std::string> scenes;  // files, besides the built-in ones
  std::string pin = "0";            // of meshes
  int cells = 1000;                 // per side of the X-Y plane
  long steps = 1024;                // of each cell
  bool quick = false;
  std::vector<Method> methods = all_methods();
  std::string output;  // folder, empty for none
  EarlierRun earlier;
};

/// Compares each method's region with simulated cells and each scene's limits with simulated cloth; writes
/// the CSV files where a folder is given. Keys: cells, disagreements, outside_band (sums over methods),
/// plane[], duration [s], linear_steps, linear_runs, linear_disagreements, linear_outside_band, safety[] (a
/// row per scene, damping and method), switching, pendulum. Throws InputError for bad options and unusable
/// scenes.
Json divergence(const CommonOptions& common, const DivergenceOptions& options);

/// The figure of a damped net's eigenpairs and numerical range in the regions of two methods.
Figure divergence_map();

}  // namespace springstab
