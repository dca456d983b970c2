// What `springstab simulate` is asked.
#pragma once

#include <optional>
#include <string>

#include "experiments/command/options.h"
#include "experiments/inputs/subject.h"

namespace springstab {

struct SimulateOptions {
  InputOptions input;
  std::string method;              // empty where `error` chooses it
  std::string methods;             // to choose from, see methods_option
  std::optional<double> error;     // to be reached
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
  int newton = 1;       // steps of Newton's method within an implicit step
  bool direct = false;  // a factorization instead of conjugate gradients
  bool keep_diverged = false;
  std::string picture;  // file for a quick look: .png or .gif
  EarlierRun earlier;
};

/// Runs a scene or a system of matrices; returns an ExitStatus.
int run_simulate(const CommonOptions& common, const SimulateOptions& options);

}  // namespace springstab
