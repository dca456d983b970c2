// Boost.odeint's Dormand-Prince pair of orders 5 and 4 with its step-size control.
#include <boost/numeric/odeint/integrate/integrate_times.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <stdexcept>

#include "experiments/precision/peers.h"
#include "experiments/precision/scales.h"

namespace springstab {
namespace {

namespace odeint = boost::numeric::odeint;

using Unknowns = std::vector<double>;

struct GaveUp {};

// The library knows one absolute tolerance for all unknowns: that of the places.
Attempt attempt_odeint(Problem& problem, double tolerance, double time_limit) {
  FirstOrderProblem equations(problem, time_limit);
  const Vector start = equations.start();
  Unknowns y(start.data(), start.data() + start.size());
  std::vector<double> times = sample_times(problem);
  times.insert(times.begin(), 0);
  const auto stepper = odeint::make_controlled(tolerance * scales_of(problem).place, tolerance,
                                               odeint::runge_kutta_dopri5<Unknowns>());
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

}  // namespace

Contestant odeint_contestant(Problem& problem) {
  Contestant contestant;
  contestant.name = "Boost.odeint dopri5";
  contestant.library = true;
  contestant.settings = peer_tolerances();
  contestant.attempt = [&problem](double tolerance, double time_limit) {
    return attempt_odeint(problem, tolerance, time_limit);
  };
  return contestant;
}

}  // namespace springstab
