// Error against run time: every contestant solves one problem over and over, more and more precisely, and
// each run's errors, CPU time and counts are kept.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/runs/journal.h"
#include "experiments/runs/measured_run.h"
#include "experiments/studies/precision/reference.h"

namespace springstab {

/// How a run ended. Only a finished one has errors, which may still be large.
enum class Outcome {
  finished,
  diverged,
  timed_out,
  failed,  // a linear solve, or a library's own error
};

const char* name(Outcome outcome);

Json json_of(const Errors& errors);

/// One run, of a method at a step or of a library at a tolerance.
struct Attempt {
  Outcome outcome = Outcome::finished;
  Trajectory trajectory;
  long steps = 0;
  Counts counts;
  double seconds = 0;  // CPU
};

struct Contestant {
  std::string name;               // in legends and tables
  bool library = false;           // not one of the project's methods: settings are tolerances
  std::optional<double> limit{};  // largest stable step [s]; nothing where it is not known
  std::vector<double> settings;   // steps [s] or relative tolerances, from coarse to fine
  std::function<Attempt(double setting, double time_limit)> attempt;
};

struct ContestOptions {
  double time_limit = 0.5;  // of one run, CPU seconds
  int repetitions = 5;      // that are timed, after one that is not
  bool libraries = true;    // but not where the damping is fitted to a step
  std::vector<Method> methods = all_methods();
  ReferenceOptions reference{};
};

struct ContestRun {
  double setting = 0;  // step [s], or a library's relative tolerance
  Outcome outcome = Outcome::finished;
  bool compared = false;         // finished, with errors at least 100 times the reference's
  std::optional<Errors> errors;  // of a finished run
  long steps = 0;
  Counts counts;
  std::vector<double> seconds;  // CPU, one a repetition; one alone where the run did not finish

  double median_seconds() const;
  /// Passes over all springs or blocks: force evaluations, assemblies and products.
  long equivalents() const {
    return counts.force_evaluations + counts.hessian_assemblies + counts.block_products;
  }
};

struct ContestSeries {
  Contestant contestant;
  std::vector<ContestRun> runs;
};

struct ContestResult {
  std::string title;
  double duration = 0, k0 = 0, set_up_seconds = 0;
  bool designed = false;
  Reference reference;
  ContestOptions options;
  std::vector<ContestSeries> series;

  const ContestSeries& of(const std::string& name) const;
};

/// These methods; implicit Euler on scenes once for each of three tolerances of its conjugate gradients, more
/// precise ones with 1e-6.
/// Steps begin just above a known limit, then 0.99 of it and halves; where no limit is known (or none is
/// stable), at twice symplectic Euler's; where nothing limits them, at a sixteenth of the duration. All are
/// such that whole steps and whole linearizations end at the trajectory's samples.
std::vector<Contestant> method_contestants(Problem& problem,
                                           const std::vector<Method>& methods = all_methods());

/// In one linearization of the linearized methods.
inline constexpr long contest_steps_per_linearization = 8;

/// Each contestant goes through its settings until a run takes longer than the limit, or its errors are
/// within 100 times the reference's own, or rounding makes them grow again. Each setting of a contestant is a
/// piece of the journal.
ContestResult run_contest(Problem& problem, const std::string& cache, const ContestOptions& options,
                          const CommonOptions& common, Journal& journal = Journal::none());

/// One row a run.
void write_runs(const std::string& path, const ContestResult& result);

/// The cheapest compared run of a contest whose trajectory error is at most `wanted`.
struct Cheapest {
  const Contestant* contestant = nullptr;  // null where none is that precise
  const ContestRun* run = nullptr;
};
Cheapest cheapest(const ContestResult& result, double wanted, bool libraries);

}  // namespace springstab
