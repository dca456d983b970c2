#include "analysis/gsl/adaptive_integrator.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

  // ∂(v, a)/∂(x, v), by rows; a by one-sided differences at √ε of each unknown or of its scale.
  static int jacobian(double t, const double y[], double* by_rows, double dfdt[], void* self_pointer) {
    auto& self = *static_cast<FirstOrder*>(self_pointer);
    const Eigen::Index n = self.system.size();
    Eigen::Map<Vector>(dfdt, 2 * n).setZero();
    Vector moved = Eigen::Map<const Vector>(y, 2 * n), here(2 * n), there(2 * n);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(by_rows, 2 * n,
                                                                                         2 * n);
    if (const int status = derivative(t, y, here.data(), self_pointer); status != GSL_SUCCESS) return status;
    for (Eigen::Index j = 0; j < 2 * n; ++j) {
      const double scale = j < n ? self.options.place_scale : self.options.velocity_scale;
      moved[j] += std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(std::abs(y[j]), scale);
      if (const int status = derivative(t, moved.data(), there.data(), self_pointer); status != GSL_SUCCESS)
        return status;
      J.col(j) = (there - here) / (moved[j] - y[j]);
      moved[j] = y[j];
    }
    return GSL_SUCCESS;
  }
};

const gsl_odeiv2_step_type* type_of(AdaptiveMethod method) {
  switch (method) {
    case AdaptiveMethod::rk8pd:
      return gsl_odeiv2_step_rk8pd;
    case AdaptiveMethod::rkf45:
      return gsl_odeiv2_step_rkf45;
    case AdaptiveMethod::bsimp:
      return gsl_odeiv2_step_bsimp;
    case AdaptiveMethod::msbdf:
      return gsl_odeiv2_step_msbdf;
  }
  throw std::invalid_argument("there is no such adaptive method");
}

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
  gsl_odeiv2_system equations{FirstOrder::derivative, FirstOrder::jacobian, size, &problem};
  double t = 0, h = times.empty() ? 0 : 1e-6 * times.back();
  // It holds together what the step, its control and its evolution are to know of each other.
  const Handle<gsl_odeiv2_driver, gsl_odeiv2_driver_free> driver(
      gsl_odeiv2_driver_alloc_scaled_new(&equations, type_of(options.method), std::max(h, 1e-300),
                                         options.tolerance, options.tolerance, 1, 0, scale.data()));
  if (!driver) throw std::runtime_error("GSL has no memory for its integrator");

  AdaptiveResult result;
  bool good = true;
  for (double end : times) {
    for (; good && t < end; ++result.steps)
      good = gsl_odeiv2_evolve_apply(driver->e, driver->c, driver->s, &equations, &t, end, &h, y.data()) ==
             GSL_SUCCESS;
    if (!good) break;
    result.at.push_back({y.head(n), y.tail(n)});
  }
  result.finished = good;
  result.force_evaluations = problem.evaluations;
  return result;
}

}  // namespace springstab
