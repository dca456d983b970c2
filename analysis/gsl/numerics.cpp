#include "analysis/gsl/numerics.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_poly.h>
#include <gsl/gsl_roots.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "analysis/gsl/error_handler.h"

namespace springstab {
namespace {

constexpr int most_iterations = 100;

// f must outlive the use of the result.
gsl_function as_gsl_function(const RealFunction& f) {
  return {[](double t, void* p) { return (*static_cast<const RealFunction*>(p))(t); },
          const_cast<RealFunction*>(&f)};
}

}  // namespace

double root_between(const RealFunction& f, double a, double b) {
  use_error_statuses();
  gsl_function function = as_gsl_function(f);
  const std::unique_ptr<gsl_root_fsolver, void (*)(gsl_root_fsolver*)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  gsl_root_fsolver_set(solver.get(), &function, a, b);
  for (int i = 0; i < most_iterations; ++i) {
    gsl_root_fsolver_iterate(solver.get());
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()), gsl_root_fsolver_x_upper(solver.get()),
                               0, 4e-16) == GSL_SUCCESS)
      break;
  }
  return gsl_root_fsolver_root(solver.get());
}

double minimum_near(const RealFunction& f, double a, double b, double c) {
  use_error_statuses();
  gsl_function function = as_gsl_function(f);
  const std::unique_ptr<gsl_min_fminimizer, void (*)(gsl_min_fminimizer*)> solver(
      gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  if (gsl_min_fminimizer_set(solver.get(), &function, b, a, c) != GSL_SUCCESS) return f(b);
  for (int i = 0; i < most_iterations; ++i) {
    if (gsl_min_fminimizer_iterate(solver.get()) != GSL_SUCCESS) break;
    if (gsl_min_test_interval(gsl_min_fminimizer_x_lower(solver.get()),
                              gsl_min_fminimizer_x_upper(solver.get()), 0, 1e-10) == GSL_SUCCESS)
      break;
  }
  return gsl_min_fminimizer_f_minimum(solver.get());
}

Integral integral(const RealFunction& f, double a, double b) {
  use_error_statuses();
  constexpr std::size_t intervals = 200;
  const std::unique_ptr<gsl_integration_workspace, void (*)(gsl_integration_workspace*)> workspace(
      gsl_integration_workspace_alloc(intervals), gsl_integration_workspace_free);
  gsl_function function = as_gsl_function(f);
  Integral result;
  const int status = gsl_integration_qag(&function, a, b, 1e-13, 1e-12, intervals, GSL_INTEG_GAUSS31,
                                         workspace.get(), &result.value, &result.error);
  if (status != GSL_SUCCESS) result.failure = gsl_strerror(status);
  return result;
}

std::vector<std::complex<double>> polynomial_roots(std::span<const double> c) {
  if (c.size() < 2 || c.back() == 0)
    throw std::invalid_argument("roots of a polynomial of " + std::to_string(c.size()) +
                                " coefficients, expected two or more, the last not 0");
  use_error_statuses();
  std::vector<std::complex<double>> roots(c.size() - 1);
  const std::unique_ptr<gsl_poly_complex_workspace, void (*)(gsl_poly_complex_workspace*)> workspace(
      gsl_poly_complex_workspace_alloc(c.size()), gsl_poly_complex_workspace_free);
  // An array of complex numbers is one of their real and imaginary parts in turn.
  if (gsl_poly_complex_solve(c.data(), c.size(), workspace.get(), reinterpret_cast<double*>(roots.data())) !=
      GSL_SUCCESS)
    throw std::runtime_error("GSL found no roots of a polynomial of degree " + std::to_string(roots.size()));
  return roots;
}

LineFit fit_line(std::span<const double> u, std::span<const double> v) {
  use_error_statuses();
  double intercept, slope, var_intercept, covariance, var_slope, residual;
  gsl_fit_linear(u.data(), 1, v.data(), 1, u.size(), &intercept, &slope, &var_intercept, &covariance,
                 &var_slope, &residual);
  const double quantile = gsl_cdf_tdist_Pinv(0.975, static_cast<double>(u.size() - 2));
  return {intercept, slope, quantile * std::sqrt(var_slope)};
}

}  // namespace springstab
