// Explicit Runge-Kutta methods: the tableau is the method.
//
// For x' = v, v' = a(x, v), stage i of s sits at
//     x_i = x + h Σ_{j<i} a_ij v_j,   v_i = v + h Σ_{j<i} a_ij a_j,   a_j = a(x_j, v_j),
// and the step ends at x + h Σ b_i v_i, v + h Σ b_i a_i. (Time does not appear: forces are autonomous.)
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "solvers/step_by_rows.h"
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
    advance<tableau.b>(h, state, x_, v_new_, all);
    return commit(state, x_, v_new_);
  }

  /// The same step of this state by rows.
  class ByRows : public StepByRows {
   public:
    ByRows(ExplicitRungeKutta& steps, double h, State<V>& state) : steps_(steps), h_(h), state_(state) {
      for (std::size_t i = 0; i < tableau.stages; ++i) {
        steps.a_[i].resize(state.x.size());
        if (i > 0) steps.v_[i].resize(state.x.size());
      }
      if (tableau.stages > 1) steps.x_.resize(state.x.size());
    }
    static constexpr int all_stages = tableau.stages;
    int stages() const final { return all_stages; }
    const V& x(int stage) const final { return stage == 0 ? state_.x : steps_.x_; }
    const V& v(int stage) const final { return stage == 0 ? state_.v : steps_.v_[stage]; }
    V& acceleration(int stage) final { return steps_.a_[stage]; }
    void advance(int stage, const IndexRange& unknowns) override {
      steps_.template advance_after<0>(stage, h_, state_, entries(unknowns));
    }

   private:
    ExplicitRungeKutta& steps_;
    double h_;
    State<V>& state_;
  };

 private:
  // All entries of a vector, as it is.
  static constexpr auto all = [](auto& u) -> auto& { return u; };

  template <class System, std::size_t... i>
  void evaluate_stages(System& system, double h, const State<V>& state, std::index_sequence<i...>) {
    (evaluate_stage<i>(system, h, state), ...);
  }

  template <std::size_t i, class System>
  void evaluate_stage(System& system, double h, const State<V>& state) {
    if constexpr (i == 0) {
      system.acceleration(state.x, state.v, a_[0]);
    } else {
      advance<tableau.a[i]>(h, state, x_, v_[i], all);
      system.acceleration(x_, v_[i], a_[i]);
    }
  }

  // From a stage, which is i or a later one, to the next or to the end of the step.
  template <std::size_t i, class Part>
  void advance_after(int stage, double h, State<V>& state, const Part& part) {
    if constexpr (i + 1 == tableau.stages) {
      advance<tableau.b>(h, state, state.x, state.v, part);
    } else if (stage == i) {
      advance<tableau.a[i + 1]>(h, state, x_, v_[i + 1], part);
    } else {
      advance_after<i + 1>(stage, h, state, part);
    }
  }

  // x = state.x + h Σ w_j v_j and v = state.v + h Σ w_j a_j over the stages so far, in a part of the entries;
  // x and v may be the state's own.
  template <auto w, class Part>
  void advance(double h, const State<V>& state, V& x, V& v, const Part& part) const {
    part(x) = part(state.x) + weighted<w, next<w>(0)>(h, [&](auto j) -> decltype(auto) {
                return part(j == 0 ? state.v : v_[j]);
              });
    part(v) =
        part(state.v) + weighted<w, next<w>(0)>(h, [&](auto j) -> decltype(auto) { return part(a_[j]); });
  }

  // The first stage from j on whose weight is not zero.
  template <auto w>
  static constexpr std::size_t next(std::size_t j) {
    while (j < w.size() && w[j] == 0) ++j;
    return j;
  }

  template <auto w, std::size_t j, class Slope>
  static auto weighted(double h, const Slope& slope) {
    auto&& s = slope(std::integral_constant<std::size_t, j>());
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
