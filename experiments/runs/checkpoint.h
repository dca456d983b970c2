// A run of `simulate` on disk, so that an interrupted one goes on where it was.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "experiments/command/output.h"
#include "solvers/simulation.h"

namespace springstab {

/// A run at one of its checkpoints.
struct KeptRun {
  RunSoFar run;
  State<Vector> state;
  Json others;  // whatever else its owner needs
};

/// DIR/simulate.checkpoint: a line of JSON, the state as it lies in memory with all that the method carries,
/// and a hash of both. It is replaced whole.
class CheckpointFile {
 public:
  /// Nowhere if the folder is empty. Without `resume` a file of an earlier run is removed. Throws InputError
  /// if another process uses the folder.
  CheckpointFile(const std::string& folder, const Json& identity, bool resume, bool quiet);

  /// What is there, if there is anything. Throws InputError for another run's or a damaged one.
  std::optional<KeptRun> read();

  /// Not more often than every 0.2 s, nor for more than a hundredth of the time.
  bool is_due() const { return !path_.empty() && Clock::now() >= due_; }
  /// Throws InputError if it cannot be written, std::logic_error for a number that is not finite.
  void save(const KeptRun& kept);
  /// The time up to which the run is saved [s]; 0 where it is not, and begins anew.
  double saved_until() const { return saved_until_; }

  /// The run is complete and reported.
  void finish() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<FolderLock> lock_;
  std::string path_;
  Json identity_;
  Clock::time_point due_;
  double saved_until_ = 0;
};

}  // namespace springstab
