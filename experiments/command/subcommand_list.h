// The subcommands of `springstab`: each says what it is called, which options it takes and how it is run, as
// data, so that the parser of command lines is known to this folder alone.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "experiments/command/options.h"

namespace springstab {

/// An option of a subcommand, or an operand if its name has no dashes:
///     Option("--nx", &nx, "cells along X").with_default()
struct Option {
  /// What is set when the option is given; a bool is a flag, and "!--no-x" sets it to false.
  using Target = std::variant<bool*, int*, long*, double*, std::string*, std::vector<std::string>*,
                              std::optional<int>*, std::optional<long>*, std::optional<double>*>;

  Option(std::string its_name, Target its_target, std::string its_help)
      : name(std::move(its_name)), target(its_target), help(std::move(its_help)) {}

  /// What stands for the value in the help instead of its type.
  Option shown_as(std::string text) && { return value = std::move(text), std::move(*this); }
  /// The help says what the target holds before, or this text.
  Option with_default(std::string text = "") && {
    return default_shown = true, default_text = std::move(text), std::move(*this);
  }
  Option needed() && { return required = true, std::move(*this); }
  Option one_of(std::vector<std::string> words) && { return known = std::move(words), std::move(*this); }

  std::string name;
  Target target;
  std::string help;
  std::optional<std::string> value{};
  bool default_shown = false, required = false;
  std::string default_text{};
  std::vector<std::string> known{};
};

/// A subcommand. `options` point into what `run` owns; `run` returns an ExitStatus and prints its result on
/// stdout.
struct Subcommand {
  std::string name;
  std::string title;   // one line
  std::string footer;  // below the options in its help
  std::vector<Option> options;
  std::function<int(const CommonOptions&)> run;
};

Subcommand methods_command();         // the methods with their constants
Subcommand region_command();          // stable region of one method in the X-Y plane
Subcommand limits_command();          // stable steps and damping of a structure
Subcommand report_command();          // the answer as a page
Subcommand simulate_command();        // runs a scene or a system of matrices
Subcommand complexity_command();      // what the methods cost (paper §5)
Subcommand work_precision_command();  // error against run time on a scene or a system of matrices
Subcommand divergence_command();      // theory against simulation
Subcommand probe_command();           // another program's integrator
Subcommand diagnose_command();        // a run that blew up, from its frames
Subcommand stress_command();          // stiff, extreme and hostile cases by every method
Subcommand doctor_command();          // what is built in, and a self-check
Subcommand figures_command();         // computes and plots

}  // namespace springstab
