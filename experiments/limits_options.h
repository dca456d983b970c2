// What `springstab limits` is asked.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "experiments/command/options.h"
#include "experiments/command/subcommand_list.h"
#include "experiments/inputs/subject.h"

namespace springstab {

struct LimitsOptions {
  InputOptions input;
  std::string method;   // empty for `methods`
  std::string methods;  // see methods_option
  double safety = 1.5;
  double max_step = 0.01;  // [s], where nothing limits the step
  bool certify = false;
  double certify_loss = 1e-3;          // of h
  int digits = 0;                      // of h; 0: all, or 4 of many unknowns
  std::optional<double> error{};       // that the cheapest method is to reach
  std::optional<double> frame_rate{};  // [1/s]
  std::optional<double> for_step{};    // at which methods are to hold [s]
  int substeps = 0;                    // of a frame; 0: not given
  bool explain = false;                // what decides the step
  std::string mode;                    // file for the stiffest mode
  std::string picture;                 // file for the scene: .png
};

/// The subcommand, run by whoever answers.
Subcommand limits_command(std::function<int(const CommonOptions&, const LimitsOptions&)> run);

/// Throws InputError for numbers that are out of range and options that exclude each other.
void check_limits_options(const CommonOptions& common, const LimitsOptions& options);

/// Stable steps and damping of a structure; returns an ExitStatus.
int run_limits(const CommonOptions& common, const LimitsOptions& options);

}  // namespace springstab
