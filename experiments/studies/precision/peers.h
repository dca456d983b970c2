// What else solves the same problem: integrators of libraries, that choose their steps by a tolerance.
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/precision/contest.h"

namespace springstab {

/// GSL's always, but its implicit ones, whose matrices are dense, for at most 400 unknowns; Boost.odeint's
/// and SUNDIALS' where they were found when this was built. Forces are the problem's own and counted alike.
/// Tolerances are relative, and absolute after multiplication with the problem's scales.
std::vector<Contestant> peer_contestants(Problem& problem);

/// Those that were not found, for a message; empty if none is missing.
std::string missing_peers();

/// 0.1, 0.01 ... 1e-12.
std::vector<double> peer_tolerances();

/// The problem as a library sees it, y = (x, v) and y' = (v, a(x, v)), with a look at the clock.
class FirstOrderProblem {
 public:
  FirstOrderProblem(Problem& problem, double time_limit);

  Eigen::Index size() const { return 2 * counted_.size(); }
  /// x and v of the start as one vector.
  Vector start() const;
  /// False when time is up or the acceleration is not finite; timed_out() then says which.
  bool derivative(const double* y, double* dydt);
  bool timed_out() const { return timed_out_; }

  /// Keeps a sample.
  void arrive(const double* y);
  /// Ends the run, whose success the library knows.
  Attempt finish(bool success, long steps);

 private:
  CountingSystem counted_;
  Attempt attempt_;
  State<Vector> start_;
  double time_limit_, before_;
  bool timed_out_ = false;
  Vector x_, v_, a_;
};

/// A library's solver at a relative tolerance, within a time limit.
Contestant library_contestant(const std::string& name, Problem& problem,
                              Attempt (*attempt)(Problem&, double tolerance, double time_limit));

Contestant odeint_contestant(Problem& problem);
std::vector<Contestant> sundials_contestants(Problem& problem);

/// Boost.odeint's extrapolated midpoint rule (Bulirsch and Stoer), which shares no formula with Runge-Kutta
/// pairs: what references are checked with.
Attempt attempt_bulirsch_stoer(Problem& problem, double tolerance, double time_limit);

}  // namespace springstab
