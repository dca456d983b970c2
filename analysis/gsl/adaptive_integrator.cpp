#include "analysis/gsl/adaptive_integrator.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <memory>
#include <stdexcept>

#include "analysis/gsl/error_handler.h"

namespace springstab {
namespace {

/// y = (x, v) as one vector for the library.
struct FirstOrder {
  System& system;
  const AdaptiveOptions& options;
  long evaluations = 0;
  Vector x{}, v{}, a{};

  static int derivative(double, const double y[], double dydt[], void* self_pointer) {
    auto& self = *static_cast<FirstOrder*>(self_pointer);
    if (self.options.give_up && self.options.give_up()) return GSL_EBADFUNC;
    const Eigen::Index n = self.system.size();
    self.x = Eigen::Map<const Vector>(y, n);
    self.v = Eigen::Map<const Vector>(y + n, n);
    self.system.acceleration(self.x, self.v, self.a);
    ++self.evaluations;
    if (!self.a.allFinite()) return GSL_FAILURE;  // the library tries a smaller step
    Eigen::Map<Vector>(dydt, n) = self.v;
    Eigen::Map<Vector>(dydt + n, n) = self.a;
    return GSL_SUCCESS;
  }
};

template <class T, void (*release)(T*)>
struct Release {
  void operator()(T* p) const { release(p); }
};
template <class T, void (*release)(T*)>
using Handle = std::unique_ptr<T, Release<T, release>>;

}  // namespace

AdaptiveResult integrate_adaptively(System& system, const State<Vector>& start,
                                    const std::vector<double>& times, const AdaptiveOptions& options) {
  use_error_statuses();
  const Eigen::Index n = system.size();
  if (!(options.tolerance > 0)) throw std::invalid_argument("the tolerance must be positive");
  Vector y(2 * n), scale(2 * n);
  y << start.x, start.v;
  scale << Vector::Constant(n, options.place_scale), Vector::Constant(n, options.velocity_scale);

  const std::size_t size = static_cast<std::size_t>(2 * n);
  FirstOrder problem{system, options};
  gsl_odeiv2_system equations{FirstOrder::derivative, nullptr, size, &problem};
  const gsl_odeiv2_step_type* type =
      options.method == AdaptiveMethod::rk8pd ? gsl_odeiv2_step_rk8pd : gsl_odeiv2_step_rkf45;
  const Handle<gsl_odeiv2_step, gsl_odeiv2_step_free> step(gsl_odeiv2_step_alloc(type, size));
  const Handle<gsl_odeiv2_control, gsl_odeiv2_control_free> control(
      gsl_odeiv2_control_scaled_new(options.tolerance, options.tolerance, 1, 0, scale.data(), size));
  const Handle<gsl_odeiv2_evolve, gsl_odeiv2_evolve_free> evolve(gsl_odeiv2_evolve_alloc(size));

  AdaptiveResult result;
  double t = 0, h = times.empty() ? 0 : 1e-6 * times.back();
  bool good = true;
  for (double end : times) {
    for (; good && t < end; ++result.steps)
      good = gsl_odeiv2_evolve_apply(evolve.get(), control.get(), step.get(), &equations, &t, end, &h,
                                     y.data()) == GSL_SUCCESS;
    if (!good) break;
    result.at.push_back({y.head(n), y.tail(n)});
  }
  result.finished = good;
  result.force_evaluations = problem.evaluations;
  return result;
}

}  // namespace springstab
