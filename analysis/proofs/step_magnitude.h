// What a method's step adds up: a bound on the rounding of its transition matrix.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string_view>

#include "solvers/state.h"

namespace springstab {

/// The transition matrix, 2n x 2n over (x, v), of one step of length 1 of x'' = -Kx - Dv with every term
/// taken as positive: |K|, |D| entry by entry, differences as sums, factors by their size. An entry computed
/// in floating point is off by at most a few roundings of it. Nothing for methods that need more of a system
/// than its accelerations.
std::optional<Eigen::MatrixXd> step_magnitude(std::string_view method, const Eigen::MatrixXd& stiffness,
                                              const Eigen::MatrixXd& damping);

/// Sizes of the unknowns from each of the 2n unit starts, in columns.
struct Magnitude {
  Eigen::MatrixXd entries;

  bool allFinite() const {  // NOLINT(readability-identifier-naming): is_finite asks Eigen's types for it
    return entries.allFinite();
  }
  friend Magnitude operator+(const Magnitude& a, const Magnitude& b) { return {a.entries + b.entries}; }
  friend Magnitude operator-(const Magnitude& a, const Magnitude& b) { return a + b; }
  friend Magnitude operator*(double factor, const Magnitude& a) { return {std::abs(factor) * a.entries}; }
};

struct MagnitudeSystem {
  Eigen::MatrixXd stiffness, damping;

  void acceleration(const Magnitude& x, const Magnitude& v, Magnitude& a) const {
    a.entries = stiffness * x.entries + damping * v.entries;
  }
};

/// The same of any method; nothing where its step asks for more than MagnitudeSystem has.
template <class Method>
std::optional<Eigen::MatrixXd> magnitude(MagnitudeSystem& system) {
  const Eigen::Index n = system.stiffness.rows();
  State<Magnitude> state{{Eigen::MatrixXd::Identity(n, 2 * n)}, {Eigen::MatrixXd::Zero(n, 2 * n)}};
  state.v.entries.rightCols(n).setIdentity();
  if constexpr (requires(Method method) { method.step(system, 1.0, state); }) {
    Method method;
    if (method.step(system, 1.0, state) != StepStatus::done) return std::nullopt;
    Eigen::MatrixXd result(2 * n, 2 * n);
    result << state.x.entries, state.v.entries;
    return result;
  } else {
    return std::nullopt;
  }
}

}  // namespace springstab
