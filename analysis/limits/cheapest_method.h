// The method that costs least: each at its own step, stable or as an error asks for, on the structure itself.
//     cost = CPU time of a step / its length, in CPU-seconds a simulated second
// The CPU time is measured over a few steps from the start of a run; everything else is computed.
//
//     StructureLimits answer(model.structure(start), {.max_step = 0.01});
//     const CheapestMethod cheapest(answer, model, start, all_methods(), {.error = 0.01});
//     if (const MethodCost* best = cheapest.best())
//       std::cout << best->method.name() << " at " << best->step << " s\n";
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/limits/step_for_error.h"
#include "analysis/limits/structure_limits.h"

namespace springstab {

/// At least one step.
struct Substeps {
  long number;  // a frame
  double step;  // [s]
};

/// The fewest equal steps of a frame of 1/rate [s] that are none longer than `largest_step` [s]. Throws
/// std::invalid_argument for more than 1e15.
Substeps substeps_of_frame(double rate, double largest_step);

struct CheapestOptions {
  std::optional<double> error{};       // to be reached; else stable is enough
  std::optional<double> duration{};    // over which errors count [s]; else see CheapestMethod::duration
  std::optional<double> frame_rate{};  // whole numbers of steps a frame [1/s]
  double relinearize = 0.01;           // h_m of the linearized methods [s]
  double budget = 1e-3;                // of CPU time a method, beyond its first two steps [s]
};

struct MethodCost {
  Method method;
  double step;                           // [s]
  std::optional<double> error;           // predicted, where one was asked for
  bool by_stability = true;              // what limits the step; else the error
  std::optional<double> cpu_per_step{};  // [s]; nothing where a step failed

  /// CPU-seconds a simulated second.
  std::optional<double> cost() const {
    return cpu_per_step ? std::optional(*cpu_per_step / step) : std::nullopt;
  }
};

/// CPU time of a step of a run that linearizes every `relinearize` seconds [s]: the median of a few from
/// `start`. Nothing where one of the first two fails.
std::optional<double> cpu_per_step(System& system, const Method& method, double h, const State<Vector>& start,
                                   const CheapestOptions& options = {});

class CheapestMethod {
 public:
  /// `model` is that of `answer`, whose damping it has again in the end.
  CheapestMethod(StructureLimits& answer, Model& model, const State<Vector>& start,
                 std::span<const Method> methods, const CheapestOptions& options);

  CheapestMethod(const CheapestMethod&) = delete;

  /// Those with a step, in the order of the methods. Where an error is asked for, a linearized method stands
  /// among them only if it is the only method: of a linear system it takes the steps of the method inside,
  /// and a scene's has its error in forces that stay frozen, which the linear system does not show.
  const std::vector<MethodCost>& candidates() const { return candidates_; }
  const MethodCost* find(const Method& method) const;
  /// Of those whose steps succeed the two that cost least; null where there is none.
  const MethodCost* best() const { return best_; }
  const MethodCost* second() const { return second_; }

  /// Over which errors count [s]: that of the options, the motion's slowest period, or 1 s where nothing
  /// brings it back.
  double duration() const { return duration_; }
  /// Where an error is asked for: nothing if the structure is not symmetric, which has no such modes.
  const std::optional<MotionSpectrum>& motion() const { return motion_; }

 private:
  void choose_steps(StructureLimits& answer, std::span<const Method> methods, const CheapestOptions& options);
  void measure(Model& model, const State<Vector>& start, const CheapestOptions& options);

  std::vector<MethodCost> candidates_;
  std::optional<MotionSpectrum> motion_;
  double duration_ = 1;
  const MethodCost *best_ = nullptr, *second_ = nullptr;
};

}  // namespace springstab
