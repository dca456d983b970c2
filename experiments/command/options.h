// The subcommands of `springstab`: for each its options and the function that runs it.
// Each returns the exit status of the command-line contract and prints its result on stdout.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/inputs/subject.h"

namespace springstab {

/// Accepted by every subcommand.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  int threads = 1;
};

enum ExitStatus {
  done = 0,
  internal_error = 1,
  bad_input = 2,
  no_answer = 3,
  run_diverged = 4,
  interrupted = 130
};

/// `springstab methods`: the methods with their constants.
int run_methods(const CommonOptions& common);

/// `springstab region`: stable region of one method in the X-Y plane.
struct RegionOptions {
  std::string method;
  std::string x, y;  // "A:B", empty for the region's own extent
  int nx = 400, ny = 400;
  std::string raster, boundary, pieces, cells;  // files to write, empty for none
  int simulated_cells = 0;                      // per side; 0 for none
  long cell_steps = 2000;
};
int run_region(const CommonOptions& common, const RegionOptions& options);

/// `springstab limits`: stable steps and damping of a structure.
struct LimitsOptions {
  InputOptions input;
  std::string method;  // empty for all
  double safety = 1.5;
  double max_step = 0.01;  // [s], where nothing limits the step
  bool certify = false;
};
int run_limits(const CommonOptions& common, const LimitsOptions& options);

/// `springstab simulate`: runs a scene or a system of matrices.
struct SimulateOptions {
  InputOptions input;
  std::string method;
  double duration = 0;             // [s]
  std::optional<double> step;      // [s]
  std::optional<double> max_step;  // [s]
  double safety = 1.5;
  double relinearize = 0.01;  // h_m of the linearized methods [s]
  bool designed_damping = false;
  bool projected_hessian = false;
  bool explain = false;
  std::string output;  // folder, empty for none
  std::string format = "obj";
  int frames = 100;
  double cg_tolerance = 1e-6;
  bool direct = false;  // a factorization instead of conjugate gradients
  bool resume = false;
};
int run_simulate(const CommonOptions& common, const SimulateOptions& options);

/// `springstab complexity`: what the methods cost (paper §5).
struct ComplexityOptions {
  bool quick = false;
  std::string plots, output;  // folders; without output nothing is written
  bool resume = false;
};
int run_complexity(const CommonOptions& common, const ComplexityOptions& options);

/// `springstab work-precision`: error against run time on a scene or a system of matrices.
struct WorkPrecisionOptions {
  InputOptions input;
  double duration = 0;      // [s]
  double time_limit = 0.5;  // of one run, CPU seconds
  int repetitions = 5;
  bool designed_damping = false;
  bool libraries = true;
  std::string plots, output;  // folders; no output: nothing is written
  bool resume = false;
};
int run_work_precision(const CommonOptions& common, const WorkPrecisionOptions& options);

/// `springstab divergence`: theory against simulation.
struct DivergenceOptions {
  std::vector<std::string> scenes;  // files, besides the built-in ones
  std::string pin = "0";            // of meshes
  int cells = 1000;                 // per side of the X-Y plane
  long steps = 1024;                // of each cell
  bool quick = false;
  std::string output;  // folder, empty for none
  bool resume = false;
};
int run_divergence(const CommonOptions& common, const DivergenceOptions& options);

/// `springstab stress`: stiff, extreme and hostile cases by every method, against what is expected of them.
struct StressOptions {
  std::string filter;  // part of a case's class or name, empty for all
  std::string output;  // folder, empty for none
};
int run_stress_command(const CommonOptions& common, const StressOptions& options);

/// `springstab figures`: computes and plots.
struct FiguresOptions {
  std::vector<std::string> names;  // empty for all
  bool quick = false;
  std::string plots, output;  // folders
};
int run_figures(const CommonOptions& common, const FiguresOptions& options);

/// Parses the command line, runs the subcommand, and turns what was thrown into an exit status.
int run_command(int argc, const char* const* argv);

}  // namespace springstab
