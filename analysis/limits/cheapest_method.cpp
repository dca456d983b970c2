#include "analysis/limits/cheapest_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "solvers/cpu_time.h"

namespace springstab {
namespace {

constexpr double most_substeps = 1e15;
constexpr double readable = 1e-4;       // that the clock can tell [s]
constexpr std::size_t most_times = 10;  // times that are taken

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Steps with a clock beside them.
class TimedSteps {
 public:
  TimedSteps(System& system, const Method& method, double h, const State<Vector>& start)
      : system_(system), stepper_(method.stepper()), h_(h), state_(start) {
    stepper_->start(system, h, state_);
    start_ = state_;
  }
  /// As before the first step.
  void restart(long steps_per_linearization) {
    state_ = start_;
    stepper_->restart(steps_per_linearization);
  }
  /// CPU time [s]; nothing where a step fails.
  std::optional<double> take(long steps) {
    const double before = cpu_seconds();
    for (long i = 0; i < steps; ++i)
      if (stepper_->step(system_, h_, state_) != StepStatus::done) return std::nullopt;
    return cpu_seconds() - before;
  }

 private:
  System& system_;
  std::unique_ptr<Stepper> stepper_;
  double h_;
  State<Vector> state_, start_;
};

}  // namespace

Substeps substeps_of_frame(double rate, double largest_step) {
  const double fewest = std::ceil(1 / (rate * largest_step));
  if (!(fewest <= most_substeps)) {
    std::ostringstream message;
    message << "a frame of " << 1 / rate << " s would take " << fewest << " steps, expected at most 1e15";
    throw std::invalid_argument(message.str());
  }
  Substeps substeps{std::max(1L, static_cast<long>(fewest) - 1), 0};
  while ((substeps.step = 1 / (rate * static_cast<double>(substeps.number))) > largest_step)
    ++substeps.number;
  return substeps;
}

// Steps too short for the clock are taken together, from the start again each time: what decays far becomes
// denormal. Longer ones follow each other, since the first is not like the others.
std::optional<double> cpu_per_step(System& system, const Method& method, double h, const State<Vector>& start,
                                   const CheapestOptions& options) {
  TimedSteps steps(system, method, h, start);
  const bool linearized = method.info().linearized;
  const long no_more = std::numeric_limits<long>::max();
  steps.restart(no_more);
  if (!steps.take(1)) return std::nullopt;  // workspace, pattern, factors
  std::vector<double> times;
  double spent = 0;
  for (long together = 1; times.size() < most_times && (times.empty() || spent < options.budget);) {
    const std::optional<double> time = steps.take(together);
    if (!time) break;
    spent += *time;
    if (*time < readable && spent < options.budget) {
      together *= 2;
      steps.restart(no_more);
    } else {
      times.push_back(*time / static_cast<double>(together));
      if (together > 1) steps.restart(no_more);
    }
  }
  if (times.empty()) return std::nullopt;
  const double step = median(std::move(times));
  if (!linearized) return step;
  steps.restart(1);
  const std::optional<double> with_linearization = steps.take(1);
  if (!with_linearization) return std::nullopt;
  return step + std::max(0.0, *with_linearization - step) / std::max(1.0, options.relinearize / h);
}

CheapestMethod::CheapestMethod(StructureLimits& answer, Model& model, const State<Vector>& start,
                               std::span<const Method> methods, const CheapestOptions& options) {
  if (!answer.k0().converged) return;
  if (options.error && answer.structure().matrices.symmetric) {
    motion_ = motion_spectrum(model, start, answer.k0().value);
    duration_ = options.duration.value_or(slowest_period(*motion_).value_or(1));
  }
  choose_steps(answer, methods, options);
  measure(model, start, options);
  for (const MethodCost& each : candidates_) {
    if (!each.cpu_per_step) continue;
    if (!best_ || *each.cost() < *best_->cost()) {
      second_ = std::exchange(best_, &each);
    } else if (!second_ || *each.cost() < *second_->cost()) {
      second_ = &each;
    }
  }
}

void CheapestMethod::choose_steps(StructureLimits& answer, std::span<const Method> methods,
                                  const CheapestOptions& options) {
  for (const Method& method : methods) {
    const std::optional<double> largest = answer.limits(method).recommended;
    if (!largest) continue;
    if (method.info().implicit && !answer.structure().matrices.symmetric) continue;  // no such solver
    MethodCost candidate{method, *largest, std::nullopt};
    if (options.error) {
      if (!motion_ || (method.info().linearized && methods.size() > 1)) continue;
      const auto found = step_for_error(method, *motion_, {duration_, *options.error}, *largest);
      if (!found) continue;
      candidate = {method, found->step, found->error, found->by_stability};
    }
    if (options.frame_rate) candidate.step = substeps_of_frame(*options.frame_rate, candidate.step).step;
    candidates_.push_back(std::move(candidate));
  }
}

// Damping that is fitted to the step is part of what a step costs.
void CheapestMethod::measure(Model& model, const State<Vector>& start, const CheapestOptions& options) {
  const DampingModel damping = model.damping();
  const bool designed = damping.kind == DampingModel::Kind::designed;
  for (MethodCost& each : candidates_) {
    if (designed) model.set_alpha(designed_alpha(stability_region(each.method), each.step, damping.d0));
    each.cpu_per_step = springstab::cpu_per_step(model.system(), each.method, each.step, start, options);
  }
  if (designed && !candidates_.empty()) model.design_damping();
}

const MethodCost* CheapestMethod::find(const Method& method) const {
  const auto found = std::ranges::find(candidates_, method, &MethodCost::method);
  return found == candidates_.end() ? nullptr : &*found;
}

}  // namespace springstab
