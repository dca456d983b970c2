// Boost.odeint's Dormand-Prince pair of orders 5 and 4 with its step-size control, and its method of Bulirsch
// and Stoer.
#include <boost/numeric/odeint/integrate/integrate_times.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <stdexcept>

#include "experiments/studies/precision/peers.h"
#include "experiments/studies/precision/scales.h"

namespace springstab {
namespace {

namespace odeint = boost::numeric::odeint;

using Unknowns = std::vector<double>;

struct GaveUp {};

template <class Stepper>
Attempt attempt_odeint(Problem& problem, const Stepper& stepper, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Vector start = equations.start();
  Unknowns y(start.data(), start.data() + start.size());
  std::vector<double> times = sample_times(problem);
  times.insert(times.begin(), 0);
  bool finished = true;
  std::size_t steps = 0;
  try {
    steps = odeint::integrate_times(
        stepper,
        [&](const Unknowns& at, Unknowns& dydt, double) {
          if (!equations.derivative(at.data(), dydt.data())) throw GaveUp();
        },
        y, times, 1e-6 * problem.duration(),
        [&](const Unknowns& at, double t) {
          if (t > 0) equations.arrive(at.data());
        });
  } catch (const GaveUp&) {
    finished = false;
  } catch (const std::runtime_error&) {  // no step is small enough
    finished = false;
  }
  return equations.finish(finished, static_cast<long>(steps));
}

// The library knows one absolute tolerance for all unknowns: that of the places.
Attempt attempt_dopri5(Problem& problem, double tolerance, double time_limit) {
  return attempt_odeint(problem,
                        odeint::make_controlled(tolerance * scales_of(problem).place, tolerance,
                                                odeint::runge_kutta_dopri5<Unknowns>()),
                        time_limit);
}

}  // namespace

Contestant odeint_contestant(Problem& problem) {
  return library_contestant("Boost.odeint dopri5", problem, attempt_dopri5);
}

Attempt attempt_bulirsch_stoer(Problem& problem, double tolerance, double time_limit) {
  return attempt_odeint(
      problem, odeint::bulirsch_stoer<Unknowns>(tolerance * scales_of(problem).place, tolerance, 1, 0),
      time_limit);
}

}  // namespace springstab
