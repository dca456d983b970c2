// What a method's step adds up: a bound on the rounding of its transition matrix. See Method::magnitude.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "solvers/methods/method_info.h"
#include "solvers/state.h"

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

struct MagnitudeSystem {
  Eigen::MatrixXd stiffness, damping;

  void acceleration(const Magnitude& x, const Magnitude& v, Magnitude& a) const {
    a.entries = stiffness * x.entries + damping * v.entries;
  }
};

/// Whether the method's step asks for nothing that MagnitudeSystem has not.
template <class Description>
inline constexpr bool has_step_magnitude = requires(StepsOf<Description, Magnitude> steps,
                                                    MagnitudeSystem& system, State<Magnitude>& state) {
  steps.step(system, 1.0, state);
};

template <class Description>
std::optional<Eigen::MatrixXd> step_magnitude(const Description& description,
                                              const Eigen::MatrixXd& stiffness,
                                              const Eigen::MatrixXd& damping) {
  if constexpr (has_step_magnitude<Description>) {
    MagnitudeSystem system{stiffness.cwiseAbs(), damping.cwiseAbs()};
    const Eigen::Index n = stiffness.rows(), m = 2 + description.info().memory;
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
    return result;
  } else {
    return std::nullopt;
  }
}

}  // namespace springstab
