// The state that every method advances, and what a step may report.
// Depends on nothing but the vector type, which is a template parameter everywhere:
// Eigen::VectorXd for nets and matrices, a small array for several oscillators at once,
// a rational function when the analysis asks a method for its formula.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

namespace springstab {

/// Position [m] and velocity [m/s], each with one entry per unknown, and what the method carries beyond them:
/// nothing, or vectors of the same shape whose meaning is the method's.
template <class V>
struct State {
  V x;
  V v;
  std::vector<V> memory{};
};

/// Outcome of one step. The state has advanced only if `done`; otherwise it is untouched.
enum class StepStatus {
  done,
  diverged,               // the new state is not finite
  not_positive_definite,  // the matrix of an implicit step has a direction of negative curvature: shorten h
  not_converged,          // the linear solve used up its iterations
};

/// Whether every entry is finite. Eigen's types have a member that stops at the first that is not, entry by
/// entry; a sum vectorizes: 0 times an infinity or NaN is NaN.
template <class V>
bool all_finite(const V& u) {
  if constexpr (requires { typename V::Scalar; })
    return (typename V::Scalar(0) * u).sum() == 0;
  else
    return u.allFinite();
}

inline bool all_finite(double u) { return std::isfinite(u); }

/// Eigen's own for its types: std::swap copies a fixed-size array three times, and not as it was written.
template <class V>
void exchange(V& a, V& b) {
  if constexpr (requires { a.swap(b); })
    a.swap(b);
  else
    std::swap(a, b);
}

/// Ends a step: takes over the new state from the method's workspace if it is finite.
template <class V>
StepStatus commit(State<V>& state, V& x_new, V& v_new) {
  if (!all_finite(x_new) || !all_finite(v_new)) return StepStatus::diverged;
  exchange(state.x, x_new);
  exchange(state.v, v_new);
  return StepStatus::done;
}

/// The same for a method that carries more.
template <class V>
StepStatus commit(State<V>& state, V& x_new, V& v_new, std::vector<V>& memory_new) {
  for (const V& u : memory_new)
    if (!all_finite(u)) return StepStatus::diverged;
  const StepStatus status = commit(state, x_new, v_new);
  if (status == StepStatus::done) std::swap(state.memory, memory_new);
  return status;
}

}  // namespace springstab
