#include "experiments/report/studies.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "analysis/constants.h"
#include "experiments/command/output.h"
#include "experiments/command/shared_options.h"
#include "experiments/runs/contact_steps.h"
#include "experiments/runs/moments.h"
#include "solvers/io/input_error.h"

namespace springstab {
namespace {

constexpr int outline_directions = 72;
constexpr double outline_tolerance = 1e-4;                     // of a picture
constexpr double phase = 128;                                  // √k0 times the ladder's duration
constexpr double rung_seconds = 0.05, reference_seconds = 20;  // CPU
constexpr int k0_samples = 24;
constexpr const char* nothing_stiff = "Left out: nothing is stiff here.";
constexpr double longest_motion = 1;                           // [s]
constexpr double most_steps = 4000, most_unknown_steps = 3e7;  // of the motion

// Counter-clockwise, in the plane of d over the rate √k0 and k over k0.
std::vector<ModePoint> outline_of_range(const StructuralMatrices& s, double k0) {
  const NumericalRange range(s);
  std::vector<ModePoint> points;
  Eigen::VectorXd near;
  for (int i = 0; i < outline_directions; ++i) {
    const double angle = 2 * std::numbers::pi * i / outline_directions;
    const auto found =
        range.farthest(std::cos(angle) / std::sqrt(k0), std::sin(angle) / k0, outline_tolerance, near);
    if (!found) continue;
    points.push_back(*found);
    near = found->vector;
  }
  return points;
}

std::string in_words(const std::exception& error) { return std::string("Left out: ") + error.what() + "."; }

}  // namespace

Told<ModeShape> mode_shape(LimitsAnswer& answer, const Method& method, double h) {
  const StiffestMode& k0 = answer.limits().k0();
  const StructuralMatrices& s = answer.limits().structure().matrices;
  const DampingModel& damping = answer.limits().structure().damping;
  if (!(k0.value > 0)) return {{}, nothing_stiff};
  if (!s.symmetric)
    return {{}, "Left out: K or D is not symmetric, and its modes are no points of this plane."};
  if (damping.kind == DampingModel::Kind::general) {
    if (s.size() > many_unknowns)
      return {{}, "Left out: the numerical range of so many unknowns takes too long."};
    return {ModeShape{outline_of_range(s, k0.value), false}};
  }
  const double alpha =
      damping.kind == DampingModel::Kind::designed ? designed_alpha(method, h, damping.d0) : damping.alpha;
  const double least = k0.lowest.value_or(std::max(0., k0.smallest.value_or(0)));
  const auto at = [&](double k) { return ModePoint{damping.d0 + alpha * k, k}; };
  return {ModeShape{{at(least), at(k0.value)}}};
}

Told<ContestResult> quick_ladder(const CommonOptions& common, const LimitsOptions& options,
                                 LimitsAnswer& answer, std::optional<double> duration) {
  const double k0 = answer.limits().k0().value;
  const StructuralMatrices& s = answer.limits().structure().matrices;
  if (answer.subject().contact()) return {{}, "Left out: contact has no reference to tell errors from."};
  if (!s.symmetric) return {{}, "Left out: K or D is not symmetric."};
  if (!(k0 > 0)) return {{}, nothing_stiff};
  if (s.size() > many_unknowns)
    return {{},
            text("Left out: more than %ld unknowns take too long; springstab work-precision does it.",
                 static_cast<long>(many_unknowns))};
  try {
    std::vector<Method> methods;
    for (const LimitsRow& row : answer.rows()) methods.push_back(row.method);
    Problem problem(title_of(options.input), Subject(options.input), duration.value_or(phase / std::sqrt(k0)),
                    common);
    return {run_contest(problem, "",
                        {.time_limit = rung_seconds,
                         .repetitions = 1,
                         .libraries = false,
                         .methods = methods,
                         .reference = {.checked = false, .seconds = reference_seconds}},
                        common)};
  } catch (const std::invalid_argument& error) {
    return {{}, in_words(error)};
  } catch (const InputError& error) {
    return {{}, in_words(error)};
  }
}

Told<K0AlongMotion> k0_along_motion(const CommonOptions& common, LimitsAnswer& answer, const Method& method,
                                    double step, std::optional<double> duration) {
  Subject& subject = answer.subject();
  if (subject.is_linear()) return {{}, "Left out: of matrices k0 stays what it is."};
  const double unknowns = static_cast<double>(subject.system().size());
  if (unknowns > many_unknowns)
    return {{}, "Left out: k0 of so many unknowns, again and again, takes too long."};
  const double steps = std::clamp(most_unknown_steps / unknowns, 64., most_steps);
  const double end = duration.value_or(std::min(longest_motion, steps * step));
  const StepOptions wanted{.method = method, .duration = end, .safety = answer.safety(), .seed = common.seed};
  StepChooser chooser(subject, StepsInContact(subject, answer.start(), wanted).options());
  const std::optional<StepPlan> plan = chooser.first_plan();
  if (!plan) return {{}, "Left out: no run can start, for no stable step is known."};
  const MomentsOfRun run = moments_of(subject, chooser, *plan, end,
                                      static_cast<int>(std::min<long>(plan->steps, k0_samples)), common);
  K0AlongMotion along{method.name(), plan->h, end, {}, run.time, run.status, run.done};
  double first = 0;
  for (const Moment& moment : run.moments) {
    const StiffestMode k0 = estimated_stiffest_mode(subject.structure(moment.state).matrices,
                                                    {.tolerance = 1e-8, .seed = common.seed});
    if (!k0.converged || !(k0.value > 0)) continue;
    if (first == 0) first = k0.value;
    along.points.emplace_back(moment.time, k0.value / first);
  }
  if (along.points.size() < 2) return {{}, "Left out: the run ended before it was seen twice."};
  return {along};
}

}  // namespace springstab
