// The state that every method advances, and what a step may report.
// Depends on nothing but the vector type, which is a template parameter everywhere:
// Eigen::VectorXd for nets and matrices, a small array for several oscillators at once,
// a rational function when the analysis asks a method for its formula.
#pragma once

#include <cmath>
#include <utility>

namespace springstab {

/// Position [m] and velocity [m/s], each with one entry per unknown.
template <class V>
struct State {
  V x;
  V v;
};

/// Outcome of one step. The state has advanced only if `done`; otherwise it is untouched.
enum class StepStatus {
  done,
  diverged,               // the new state is not finite
  not_positive_definite,  // 1 + hD' + h²K' has a direction of negative curvature: shorten h (paper §5.2)
  not_converged,          // the linear solve used up its iterations
};

/// Whether every entry is finite; vector types without Eigen's member overload this.
template <class V>
bool all_finite(const V& u) {
  return u.allFinite();
}

inline bool all_finite(double u) { return std::isfinite(u); }

/// Ends a step: takes over the new state from the method's workspace if it is finite.
template <class V>
StepStatus commit(State<V>& state, V& x_new, V& v_new) {
  if (!all_finite(x_new) || !all_finite(v_new)) return StepStatus::diverged;
  std::swap(state.x, x_new);
  std::swap(state.v, v_new);
  return StepStatus::done;
}

}  // namespace springstab
