// What a method's step adds up: a bound on the rounding of its transition matrix. See Method::magnitude.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "solvers/methods/method_info.h"
#include "solvers/state.h"
#include "solvers/system.h"

namespace springstab {

/// Sizes of the unknowns from each of the mn unit starts, in columns.
struct Magnitude {
  Eigen::MatrixXd entries;

  bool allFinite() const {  // NOLINT(readability-identifier-naming): is_finite asks Eigen's types for it
    return entries.allFinite();
  }
  friend Magnitude operator+(const Magnitude& a, const Magnitude& b) { return {a.entries + b.entries}; }
  friend Magnitude operator-(const Magnitude& a, const Magnitude& b) { return a + b; }
  friend Magnitude operator*(double factor, const Magnitude& a) { return {std::abs(factor) * a.entries}; }
};

/// K and D of a step, and bounds on what each of their entries sums up.
struct SizedMatrices {
  Eigen::MatrixXd stiffness, damping, stiffness_size, damping_size;
};

struct MagnitudeSystem;
template <>
struct LinearizationTrait<Magnitude> {
  using type = const MagnitudeSystem*;
};

struct MagnitudeSystem {
  const SizedMatrices& of;
  mutable long sums = 0;  // over n terms, of everything that was asked for so far

  void acceleration(const Magnitude& x, const Magnitude& v, Magnitude& a) const {
    sums += 1;
    a.entries = of.stiffness_size * x.entries + of.damping_size * v.entries;
  }
  void stiffness_times(const Magnitude& u, Magnitude& out) const {
    sums += 1;
    out.entries = of.stiffness_size * u.entries;
  }
  void damping_times(const Magnitude& u, Magnitude& out) const {
    sums += 1;
    out.entries = of.damping_size * u.entries;
  }
  SolveReport solve_shifted(const Shift& shift, const Magnitude& rhs, Magnitude& out) const;
  SolveReport solve_damping(DampingPart, double h, const Magnitude& rhs, Magnitude& out) const {
    return solve_shifted({1, h, 0}, rhs, out);
  }
  /// Nothing bounds the rounding of stages that are solved for together.
  SolveReport solve_coupled(const StageCoupling&, const std::vector<Magnitude>&,
                            std::vector<Magnitude>&) const {
    return {.status = StepStatus::not_converged};
  }
  void linearize(const Magnitude&, const Magnitude&, const MagnitudeSystem*& linear) const { linear = this; }
};

/// Whether the method's step asks for nothing that MagnitudeSystem has not.
template <class Description>
inline constexpr bool has_step_magnitude = requires(StepsOf<Description, Magnitude> steps,
                                                    MagnitudeSystem& system, State<Magnitude>& state) {
  steps.step(system, 1.0, state);
};

template <class Description>
std::optional<Eigen::MatrixXd> step_magnitude(const Description& description, const SizedMatrices& matrices) {
  if constexpr (has_step_magnitude<Description>) {
    MagnitudeSystem system{matrices};
    const Eigen::Index n = matrices.stiffness.rows(), m = 2 + description.info().memory;
    const auto unit = [&](Eigen::Index i) {
      Magnitude u{Eigen::MatrixXd::Zero(n, m * n)};
      u.entries.middleCols(i * n, n).setIdentity();
      return u;
    };
    State<Magnitude> state{unit(0), unit(1)};
    for (Eigen::Index i = 2; i < m; ++i) state.memory.push_back(unit(i));
    auto steps = make_steps<Magnitude>(description);
    if (steps.step(system, 1.0, state) != StepStatus::done) return std::nullopt;
    Eigen::MatrixXd result(m * n, m * n);
    result.topRows(n) = state.x.entries;
    result.middleRows(n, n) = state.v.entries;
    for (Eigen::Index i = 2; i < m; ++i)
      result.middleRows(i * n, n) = state.memory[static_cast<std::size_t>(i - 2)].entries;
    constexpr long few = 16;  // sums on the way to an entry
    return std::max(1.0, static_cast<double>(system.sums) / few) * result;
  } else {
    return std::nullopt;
  }
}

}  // namespace springstab
