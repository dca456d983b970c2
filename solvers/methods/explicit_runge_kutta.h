// Explicit Runge-Kutta methods: the tableau is the method.
//
// For x' = v, v' = a(x, v), stage i of s sits at
//     x_i = x + h Σ_{j<i} a_ij v_j,   v_i = v + h Σ_{j<i} a_ij a_j,   a_j = a(x_j, v_j),
// and the step ends at x + h Σ b_i v_i, v + h Σ b_i a_i. (Time does not appear: forces are autonomous.)
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "solvers/system.h"

namespace springstab {

/// Butcher tableau of an explicit method with `s` stages; a[i][j] counts only for j < i.
template <std::size_t s>
struct ExplicitTableau {
  static constexpr std::size_t stages = s;
  std::array<std::array<double, s>, s> a{};
  std::array<double, s> b{};
};

/// The method of a tableau. Zero entries are dropped at compile time, and what remains of a sum is one
/// expression, hence one pass over memory.
template <class V, auto tableau>
class ExplicitRungeKutta {
 public:
  template <Accelerating<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    evaluate_stages(system, h, state, std::make_index_sequence<tableau.stages>());
    advance<tableau.b>(h, state, x_, v_new_);
    return commit(state, x_, v_new_);
  }

 private:
  template <class System, std::size_t... i>
  void evaluate_stages(System& system, double h, const State<V>& state, std::index_sequence<i...>) {
    (evaluate_stage<i>(system, h, state), ...);
  }

  template <std::size_t i, class System>
  void evaluate_stage(System& system, double h, const State<V>& state) {
    if constexpr (i == 0) {
      system.acceleration(state.x, state.v, a_[0]);
    } else {
      advance<tableau.a[i]>(h, state, x_, v_[i]);
      system.acceleration(x_, v_[i], a_[i]);
    }
  }

  // x = state.x + h Σ w_j v_j and v = state.v + h Σ w_j a_j over the stages so far.
  template <auto w>
  void advance(double h, const State<V>& state, V& x, V& v) const {
    x = state.x + weighted<w, next<w>(0)>(h, [&](auto j) -> const V& { return j == 0 ? state.v : v_[j]; });
    v = state.v + weighted<w, next<w>(0)>(h, [&](auto j) -> const V& { return a_[j]; });
  }

  // The first stage from j on whose weight is not zero.
  template <auto w>
  static constexpr std::size_t next(std::size_t j) {
    while (j < w.size() && w[j] == 0) ++j;
    return j;
  }

  template <auto w, std::size_t j, class Slope>
  static auto weighted(double h, const Slope& slope) {
    const auto& s = slope(std::integral_constant<std::size_t, j>());
    if constexpr (next<w>(j + 1) == w.size()) {
      return (h * w[j]) * s;
    } else {
      return (h * w[j]) * s + weighted<w, next<w>(j + 1)>(h, slope);
    }
  }

  std::array<V, tableau.stages> v_, a_;  // slopes of x and v per stage; v_[0] is the state's own v
  V x_, v_new_;
};

}  // namespace springstab
