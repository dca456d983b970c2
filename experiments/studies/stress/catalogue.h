// The catalogue of stiff, extreme and hostile cases: the files that a user would hand over, and what is
// expected of every method, said before anything runs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/inputs/subject.h"

namespace springstab {

enum class StressOutcome {
  right,     // came to its end where the reference did
  diverges,  // and said so
  refused,   // the input, with the reason
  no_step,   // the method has no stable step here, with the reason
  limit,     // right as far as it came, which is not the end: a documented limit
  wrong,     // anything else: a wrong end, not a number, a hang, an internal error
};

const char* name(StressOutcome outcome);

/// One outcome for all methods but some.
struct Expectation {
  StressOutcome outcome = StressOutcome::right;
  std::vector<std::pair<std::string_view, StressOutcome>> but{};

  StressOutcome of(std::string_view method) const;
};

struct StressCase {
  std::string kind, name;
  Expectation expected;
  /// Writes the input's files into a folder.
  std::function<InputOptions(const std::string& folder)> write;
  double duration = 0;  // [s]; 0 for matrices: a quarter of the slowest mode's period
  std::optional<double>
      ratio{};           // steps are this multiple of the limit, from a random start; right is bounded
  bool compared = true;  // with a reference; else right is that energy does not grow
};

std::vector<StressCase> stress_catalogue();

}  // namespace springstab
