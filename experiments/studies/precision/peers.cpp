#include "experiments/studies/precision/peers.h"

#include <cmath>

#include "analysis/gsl/adaptive_integrator.h"
#include "experiments/studies/precision/scales.h"

namespace springstab {
namespace {

constexpr long clock_interval = 16;                // force evaluations between looks at the clock
constexpr Eigen::Index most_dense_unknowns = 400;  // GSL's elimination of 800 rows takes a third of a second

template <AdaptiveMethod method>
Attempt attempt_gsl(Problem& problem, double tolerance, double time_limit) {
  const Scales scales = scales_of(problem);
  CountingSystem counted(problem.system());
  const double before = cpu_seconds();
  bool in_time = true;
  AdaptiveResult result =
      integrate_adaptively(counted, problem.start(), sample_times(problem),
                           {.method = method,
                            .tolerance = tolerance,
                            .place_scale = scales.place,
                            .velocity_scale = scales.velocity,
                            .give_up = [&] {
                              if (counted.counts().force_evaluations % clock_interval == 0)
                                in_time = cpu_seconds() - before <= time_limit;
                              return !in_time;
                            }});
  Attempt attempt;
  attempt.seconds = cpu_seconds() - before;
  attempt.outcome = result.finished ? Outcome::finished : in_time ? Outcome::failed : Outcome::timed_out;
  attempt.steps = result.steps;
  attempt.counts = counted.counts();
  attempt.trajectory = std::move(result.at);
  attempt.trajectory.insert(attempt.trajectory.begin(), problem.start());
  return attempt;
}

}  // namespace

FirstOrderProblem::FirstOrderProblem(Problem& problem, double time_limit)
    : counted_(problem.system()), start_(problem.start()), time_limit_(time_limit), before_(cpu_seconds()) {
  attempt_.trajectory.reserve(trajectory_samples + 1);
  attempt_.trajectory.push_back(start_);
}

Vector FirstOrderProblem::start() const {
  Vector y(size());
  y << start_.x, start_.v;
  return y;
}

bool FirstOrderProblem::derivative(const double* y, double* dydt) {
  if (counted_.counts().force_evaluations % clock_interval == 0)
    timed_out_ = timed_out_ || cpu_seconds() - before_ > time_limit_;
  if (timed_out_) return false;
  const Eigen::Index n = counted_.size();
  x_ = Eigen::Map<const Vector>(y, n);
  v_ = Eigen::Map<const Vector>(y + n, n);
  counted_.acceleration(x_, v_, a_);
  Eigen::Map<Vector>(dydt, n) = v_;
  Eigen::Map<Vector>(dydt + n, n) = a_;
  return a_.allFinite();
}

void FirstOrderProblem::arrive(const double* y) {
  const Eigen::Index n = counted_.size();
  attempt_.trajectory.push_back({Eigen::Map<const Vector>(y, n), Eigen::Map<const Vector>(y + n, n)});
}

Attempt FirstOrderProblem::finish(bool success, long steps) {
  attempt_.seconds = cpu_seconds() - before_;
  attempt_.steps = steps;
  attempt_.counts = counted_.counts();
  attempt_.outcome = success ? Outcome::finished : timed_out_ ? Outcome::timed_out : Outcome::failed;
  return std::move(attempt_);
}

std::vector<double> peer_tolerances() {
  std::vector<double> tolerances;
  for (int digits = 1; digits <= 12; ++digits) tolerances.push_back(std::pow(10, -digits));
  return tolerances;
}

Contestant library_contestant(const std::string& name, Problem& problem,
                              Attempt (*attempt)(Problem&, double, double)) {
  Contestant contestant;
  contestant.name = name;
  contestant.library = true;
  contestant.settings = peer_tolerances();
  contestant.attempt = [&problem, attempt](double tolerance, double time_limit) {
    return attempt(problem, tolerance, time_limit);
  };
  return contestant;
}

std::vector<Contestant> peer_contestants(Problem& problem) {
  std::vector<Contestant> peers{library_contestant("GSL rkf45", problem, attempt_gsl<AdaptiveMethod::rkf45>)};
  if (problem.start().x.size() <= most_dense_unknowns) {
    peers.push_back(library_contestant("GSL bsimp", problem, attempt_gsl<AdaptiveMethod::bsimp>));
    peers.push_back(library_contestant("GSL msbdf", problem, attempt_gsl<AdaptiveMethod::msbdf>));
  }
#ifdef SPRINGSTAB_ODEINT
  peers.push_back(odeint_contestant(problem));
#endif
#ifdef SPRINGSTAB_SUNDIALS
  for (Contestant& peer : sundials_contestants(problem)) peers.push_back(std::move(peer));
#endif
  return peers;
}

std::string missing_peers() {
  std::string missing;
#ifndef SPRINGSTAB_ODEINT
  missing += "Boost.odeint (libboost-dev)";
#endif
#ifndef SPRINGSTAB_SUNDIALS
  missing += std::string(missing.empty() ? "" : ", ") + "SUNDIALS (libsundials-dev)";
#endif
  return missing;
}

}  // namespace springstab
