// A system of the consumer's own: three oscillators x'' = -x.
#pragma once

#include <cmath>

#include "solvers/stepper.h"

struct UnitOscillators final : springstab::LinearSystem {
  using Vector = springstab::Vector;
  Eigen::Index size() const override { return 3; }
  void acceleration(const Vector& x, const Vector&, Vector& out) override { out = -x; }
  double kinetic_energy(const Vector& v) override { return 0.5 * v.squaredNorm(); }
  double potential_energy(const Vector& x) override { return 0.5 * x.squaredNorm(); }
  void stiffness_times(const Vector& u, Vector& out) override { out = u; }
  void damping_times(const Vector& u, Vector& out) override { out = 0 * u; }
  springstab::SolveReport solve_shifted(const springstab::Shift& shift, const Vector& rhs,
                                        Vector& out) override {
    out = rhs / (shift.mass + shift.stiffness);
    return {};
  }
};

/// Largest error of the places after one period in 100 steps of a method, infinite if a step fails. The state
/// comes back in memory that the library allocated, and is freed here.
inline double error_after_a_period(const std::unique_ptr<springstab::Stepper>& stepper) {
  const double pi = std::acos(-1.0);
  UnitOscillators system;
  springstab::State<springstab::Vector> state{Eigen::Vector3d::Ones(), Eigen::Vector3d::Zero()};
  for (int i = 0; i < 100; ++i)
    if (stepper->step(system, 2 * pi / 100, state) != springstab::StepStatus::done) return INFINITY;
  return (state.x.array() - 1).abs().maxCoeff();
}
