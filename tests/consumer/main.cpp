// Uses the installed libraries from outside: a method steps an oscillator x'' = -x for one period.
// The state comes back in memory that the library allocated, and is freed here; prints the phase error.
#include <cmath>
#include <iostream>

#include "analysis/method.h"

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

int main() {
  const double pi = std::acos(-1.0);
  UnitOscillators system;
  springstab::State<springstab::Vector> state{Eigen::Vector3d::Ones(), Eigen::Vector3d::Zero()};
  const auto rk4 = springstab::Method("rk4").stepper();
  for (int i = 0; i < 100; ++i)
    if (rk4->step(system, 2 * pi / 100, state) != springstab::StepStatus::done) return 1;
  const double error = (state.x.array() - 1).abs().maxCoeff();
  std::cout << "error after one period " << error << ", one step's matrix\n"
            << springstab::Method("rk4").amplification(0.0, 1.0) << '\n';
  return error < 1e-6 ? 0 : 1;
}
