// What every subcommand of `springstab` is told, and how it answers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <thread>

namespace springstab {

/// Accepted by every subcommand.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::string command_line{};     // as it was typed, for a shell
  std::string method_file{};      // its method is known by then
  std::set<std::string> given{};  // names of the subcommand's options that were typed, as "--nx"
};

/// What is to become of an interrupted run that --output holds. Neither: the user is asked.
struct EarlierRun {
  bool resume = false, overwrite = false;
};

/// The command-line contract.
enum ExitStatus {
  done = 0,
  internal_error = 1,
  bad_input = 2,
  no_answer = 3,
  run_diverged = 4,
  interrupted = 130
};

}  // namespace springstab
