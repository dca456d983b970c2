#include "analysis/limits/step_for_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/errors/linear_motion.h"
#include "analysis/limits/step_limits.h"

namespace springstab {
namespace {

constexpr long longest_run = 1'000'000'000;
constexpr double rigid = 1e-3;  // of 1/T²: softer modes move as this one does, but for 1e-4 of their way
constexpr long accuracy = 100;  // of the step: 1 %

Eigen::MatrixXd matrix_power(Eigen::MatrixXd a, long n) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) result = (result * a).eval();
    a = (a * a).eval();
  }
  return result;
}

}  // namespace

double predicted_error(const Method& method, const MotionSpectrum& motion, double duration, long n) {
  const double h = duration / static_cast<double>(error_samples * n);
  const DampingModel& damping = motion.damping;
  const bool designed = damping.kind == DampingModel::Kind::designed;
  const double alpha = designed ? designed_alpha(stability_region(method), h, damping.d0) : 0;
  double wrong = 0, moved = 0;
  for (const MovingMode& mode : motion.modes) {
    const double softest = rigid / (duration * duration);
    const double k = std::abs(mode.k) < softest ? softest : mode.k;
    const double d = designed ? damping.d0 + alpha * k : mode.d;
    const OscillatorState start{-mode.acceleration / k, mode.velocity};
    const Eigen::MatrixXd between = matrix_power(method.amplification(h * d, h * h * k), n);
    Vector reached = method.starts(h * d, h * h * k) * Eigen::Vector2d(start.q, h * start.v);
    for (long i = 1; i <= error_samples; ++i) {
      reached = (between * reached).eval();
      const double t = duration * static_cast<double>(i) / static_cast<double>(error_samples);
      const double q = oscillator_motion(start, k, d, t).q;
      wrong += (reached[0] - q) * (reached[0] - q);
      moved += (q - start.q) * (q - start.q);
    }
  }
  const double error = wrong > 0 ? std::sqrt(wrong / moved) : wrong;
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

std::optional<StepForError> step_for_error(const Method& method, const MotionSpectrum& motion,
                                           const ErrorGoal& goal, double largest_step) {
  const auto error_of = [&](long n) { return predicted_error(method, motion, goal.duration, n); };
  const auto step_of = [&](long n) { return goal.duration / static_cast<double>(error_samples * n); };
  const double fewest = std::ceil(goal.duration / (error_samples * largest_step) * (1 - 1e-12));
  if (!(fewest <= longest_run / error_samples)) return std::nullopt;
  const long least = std::max(1L, static_cast<long>(fewest));
  double error = error_of(least);
  if (error <= goal.error) return StepForError{step_of(least), error, true};
  long missed = least, reached = least;
  while (!(error <= goal.error)) {  // as the order says, and a little more
    const double factor =
        std::isfinite(error) ? 1.02 * std::pow(error / goal.error, 1.0 / method.info().order) : 2;
    missed = reached;
    if (factor * static_cast<double>(reached) > longest_run / error_samples) return std::nullopt;
    reached = std::max(missed + 1, static_cast<long>(factor * static_cast<double>(missed)));
    error = error_of(reached);
  }
  while (reached - missed > std::max(1L, missed / accuracy)) {
    const long middle = missed + (reached - missed) / 2;
    const double there = error_of(middle);
    (there <= goal.error ? reached : missed) = middle;
    if (there <= goal.error) error = there;
  }
  return StepForError{step_of(reached), error, false};
}

}  // namespace springstab
