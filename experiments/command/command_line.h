// The whole command: main.cpp does no more than call it.
#pragma once

namespace springstab {

/// Parses the command line, runs the subcommand, and turns what was thrown into an exit status.
int run_command(int argc, const char* const* argv);

}  // namespace springstab
