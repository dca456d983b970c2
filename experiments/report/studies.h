// What a report tells beyond the limits: where the modes are, error against run time, k0 along a motion. What
// makes no sense for an input is left out, and it is said why.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/limits_answer.h"
#include "experiments/report/pictures.h"
#include "experiments/studies/precision/contest.h"

namespace springstab {

/// A value, or why there is none.
template <class Value>
struct Told {
  std::optional<Value> value{};
  std::string left_out{};
};

/// The modes of the structure: of Rayleigh damping a line, of general damping the outline of the joint
/// numerical range. `h` [s] is for damping that is fitted to the step.
Told<ModeShape> mode_shape(LimitsAnswer& answer, const Method& method, double h);

/// Every method of the answer on the same motion: of 128/√k0, 64 steps at symplectic Euler's limit, or of
/// `duration` [s].
Told<ContestResult> quick_ladder(const CommonOptions& common, const LimitsOptions& options,
                                 LimitsAnswer& answer, std::optional<double> duration);

struct K0AlongMotion {
  std::string method;
  double step, duration;                          // [s]
  std::vector<std::pair<double, double>> points;  // time [s], k0 over that of the start
  double end;                                     // how far the run came [s]
  StepStatus status;
  bool done;  // it came to its end
};

/// Of a run by this method at the step to use: 1 s or a few thousand steps, or `duration` [s]. Last of all:
/// the run may change the damping of the answer's subject, where it is left to the design.
Told<K0AlongMotion> k0_along_motion(const CommonOptions& common, LimitsAnswer& answer, const Method& method,
                                    double step, std::optional<double> duration);

}  // namespace springstab
