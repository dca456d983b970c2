// What a run of `simulate` writes as it goes: frames of a scene and their energies, or for matrices rows of
// one CSV file with both.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/runs/fnv1a.h"
#include "experiments/simulate_options.h"

namespace springstab {

/// Evenly spaced in time; nothing without an output folder. A frame is written while the run goes on, where
/// it may have a thread of its own (loop_threads); then it is from the next call on that an error shows.
class Recorder {
 public:
  /// Goes on after what another one kept(), if that is not null.
  Recorder(Subject& subject, const SimulateOptions& options, const Json& kept);

  /// What lies after t is taken back first: a divergence was undone.
  void record(double t, const State<Vector>& state);
  /// Before that time it has no use for states [s].
  double unseen_until() const;
  /// With --keep-diverged, at the end of a run that has diverged: what it saw last, each step, up to 32 of
  /// them, in place of the frames of that time.
  void record_last();
  int last_steps() const { return last_steps_; }

  /// Hands what was recorded to the system. Throws InputError if it does not take it.
  void flush();
  /// Where it is; what was recorded is on disk by then.
  Json kept();
  void finish();

  /// The first frame beyond this run's that is there, of an earlier one; empty if none is.
  std::string earlier() const;
  int written() const { return static_cast<int>(frames_.size()); }

 private:
  bool keeps_last() const { return options_.keep_diverged && !options_.output.empty(); }
  void remember(double t, const State<Vector>& state);
  void write(double t, const State<Vector>& state);
  void write_row(const std::string& row);
  void take_back_last();
  void wait_for_frame();
  void write_times();

  // A hair early: the time of a step is a rounded sum.
  double next_time() const { return options_.duration * due_ / options_.frames * (1 - 1e-9); }

  Subject& subject_;
  const SimulateOptions& options_;
  std::optional<OutputFile> csv_;
  Fnv1a csv_hash_;  // of all that is in it
  std::uintmax_t csv_bytes_ = 0;
  struct Frame {
    double t;  // [s]
    int due;
    std::uintmax_t begin;  // of its row in the CSV file [bytes]
    Fnv1a before;          // of all before that row
  };
  std::vector<Frame> frames_;
  int due_ = 0, most_ = 0;
  int on_disk_ = 0;  // frames
  struct Moment {
    double t;  // [s]
    State<Vector> state;
  };
  std::deque<Moment> last_;  // if they are to be kept, in the order of time
  int last_steps_ = 0;       // of these, recorded
  std::future<void> writing_;
};

}  // namespace springstab
