// What shells and man know of the command line, generated from the parser itself: completion and man pages.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/subcommand_list.h"

namespace CLI {
class App;
}

namespace springstab {

/// A script for "bash", "zsh" or "fish".
std::string completion_script(const CLI::App& app, const std::string& shell);

/// The page of a subcommand, in roff; of the command itself where `subcommand` is empty.
std::string man_page(const CLI::App& app, const std::string& subcommand);

/// `springstab completion SHELL` and `springstab man [SUBCOMMAND]`; `app` must outlive them.
Subcommand completion_command(const CLI::App& app);
Subcommand man_command(const CLI::App& app);

}  // namespace springstab
