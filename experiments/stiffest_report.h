// What `limits` says of what decides the step: JSON keys stiffest and cheap_bounds, --explain, --mode FILE.
#pragma once

#include "analysis/limits/stiffest_motion.h"
#include "analysis/limits/structure_limits.h"
#include "experiments/command/options.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"
#include "experiments/limits_options.h"

namespace springstab {

/// Looks for it where it is asked for, in JSON also unasked of fewer than 20 000 unknowns: the mode is
/// searched a second time.
class StiffestReport {
 public:
  /// Writes the file of --mode. `answer` must outlive it. Throws InputError where that cannot be written.
  StiffestReport(const LimitsOptions& options, const CommonOptions& common, StructureLimits& answer,
                 const Subject& subject, const State<Vector>& start);

  void add_to(Json& json) const;
  void print(std::ostream& out) const;

 private:
  void write_mode(const std::string& path, const Subject& subject, const State<Vector>& start) const;
  std::vector<long> numbers_of(const Carrier& carrier) const;

  const StructureLimits& answer_;
  double k0_;
  bool explain_;
  std::optional<StiffestMotion> motion_;
  std::vector<long> numbers_;  // of all particles, or of unknowns, in the input
};

}  // namespace springstab
