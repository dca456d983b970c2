// Options that several subcommands have.
#pragma once

#include <string>
#include <vector>

#include "analysis/method.h"
#include "experiments/command/output.h"
#include "experiments/command/subcommand_list.h"
#include "experiments/inputs/subject.h"

namespace springstab {

/// Every method's name, with commas.
std::string method_names();

/// Said where a user chooses a method.
inline constexpr char leapfrog_words[] =
    "Leapfrog with the damping of the half step before, and velocity Verlet\n"
    "with one force a step, take the steps of symplectic-euler: Y < 4 - 2X.";

/// --methods: "all", or names with commas; empty for those shown where none is named.
Option methods_option(std::string& names);
/// What --methods says, and the method of --method-file. Throws std::invalid_argument for an unknown one.
std::vector<Method> methods_of(const std::string& names);
/// The name that was given as `option`; where none was, that of the method of --method-file. Throws
/// std::invalid_argument where there is none either.
std::string method_asked_for(const std::string& name, const std::string& option);
/// For the identity of a run: --methods and the contents of --method-file, where they are given.
Json method_settings(const CommonOptions& common, const std::string& names = "");

/// Whether undamped motion grows at every step of an implicit method, which is what its parameters do: of
/// explicit methods it is expected.
bool amplifies_without_need(const Method& method);

/// What an input is called in figures: its file's name without suffix, or the grid.
std::string title_of(const InputOptions& input);

/// INPUT and what belongs to it, then `more`.
std::vector<Option> with_input(InputOptions& input, std::vector<Option> more);

/// For the commands that keep what they have finished.
Option resume_option(EarlierRun& earlier);
Option overwrite_option(EarlierRun& earlier);

/// Where the gnuplot scripts are: installed, as seen from the running command, else `plots` beside it, as in
/// a build folder. Not checked.
std::string plots_folder();

/// --plots, with that folder as default.
Option plots_option(std::string& plots);

}  // namespace springstab
