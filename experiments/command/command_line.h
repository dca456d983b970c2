// The whole command: main.cpp does no more than call it.
#pragma once

#include <string>
#include <vector>

#include "experiments/command/subcommand_list.h"

namespace springstab {

/// Parses the command line, runs the subcommand, and turns what was thrown into an exit status.
int run_command(int argc, const char* const* argv);
/// The same of a program of another name, with these subcommands.
int run_command(const std::string& program, const std::vector<Subcommand>& subcommands, int argc,
                const char* const* argv);

}  // namespace springstab
