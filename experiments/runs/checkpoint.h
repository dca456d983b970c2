// A run of `simulate` on disk, so that an interrupted one goes on where it was.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "experiments/command/options.h"
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
  /// Nowhere if the folder is empty. A file of an earlier run is removed if it is to be overwritten. Throws
  /// InputError if that is not decided (expect_decided), and if another process uses the folder.
  CheckpointFile(const std::string& folder, const Json& identity, const EarlierRun& earlier, bool quiet);

  /// What is there, if there is anything. Throws InputError for another run's or a damaged one.
  std::optional<KeptRun> read();

  /// Not more often than every 0.2 s, nor for more than a hundredth of the time.
  bool is_due() const { return !path_.empty() && Clock::now() >= due_; }
  /// The run as it is made, with all that making it takes. It counts once it is on disk, under its name.
  /// Throws InputError if it cannot be written, std::logic_error for a number that is not finite.
  void save(const std::function<KeptRun()>& make);
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
