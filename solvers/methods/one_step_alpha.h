// Newmark's method and those that weigh the equation of motion between the ends of the step (Hilber, Hughes
// and Taylor 1977; Chung and Hulbert 1993). They carry the acceleration a; with w = 1 - α_f,
//     x⁺ = x + hv + h²((½ - β)a + βa⁺),   v⁺ = v + h((1 - γ)a + γa⁺),
//     (1 - α_m)a⁺ + α_m a = a(x + w(x⁺ - x), v + w(v⁺ - v)),
// and with one Newton step from a⁺ = a, forces and their derivatives at (x + whv, v), for Δ = a⁺ - a:
//     (1 - α_m + wγhD' + wβh²K') Δ = a(x + whv, v) - a - w(hD'a + ½h²K'a).
// So the error of K' (projected, or without a damping's derivative) meets only what h²a moves.
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/system.h"

namespace springstab {

struct AlphaWeights {
  double mass = 0, force = 0;  // α_m, α_f: of the beginning of the step
  double beta = 0.25, gamma = 0.5;
};

template <class V>
class OneStepAlpha {
 public:
  explicit OneStepAlpha(const AlphaWeights& weights) : w_(weights), now_(1 - weights.force) {}

  template <Accelerating<V> System>
  void start(System& system, double, State<V>& state) {
    system.acceleration(state.x, state.v, state.memory[0]);
  }

  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    a_.resize(1);
    const V& a = state.memory[0];
    x_ = state.x + (now_ * h) * state.v;
    system.acceleration(x_, state.v, v_);
    system.linearize(x_, state.v, linear_);
    linear_->damping_times(a, change_);
    v_ = v_ - a - (now_ * h) * change_;
    linear_->stiffness_times(a, change_);
    v_ = v_ - (0.5 * now_ * h * h) * change_;
    const SolveReport solved =
        linear_->solve_shifted({1 - w_.mass, now_ * w_.gamma * h, now_ * w_.beta * h * h}, v_, change_);
    if (solved.status != StepStatus::done) return solved.status;
    x_ = state.x + h * state.v + (0.5 * h * h) * a + (w_.beta * h * h) * change_;
    v_ = state.v + h * a + (w_.gamma * h) * change_;
    a_[0] = a + change_;
    return commit(state, x_, v_, a_);
  }

 private:
  Linearization<V> linear_ = {};
  AlphaWeights w_;
  double now_;
  V x_, v_, change_;
  std::vector<V> a_;
};

}  // namespace springstab
