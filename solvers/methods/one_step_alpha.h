// Newmark's method and those that weigh the equation of motion between the ends of the step (Hilber, Hughes
// and Taylor 1977; Chung and Hulbert 1993). They carry the acceleration a; with w = 1 - α_f,
//     x⁺ = x + hv + h²((½ - β)a + βa⁺),   v⁺ = v + h((1 - γ)a + γa⁺),
//     (1 - α_m)a⁺ + α_m a = a(x + w(x⁺ - x), v + w(v⁺ - v)),
// and with one Newton step from a⁺ = a, forces and their derivatives at (x + whv, v), for Δ = a⁺ - a:
//     (1 - α_m + wγhD' + wβh²K') Δ = a(x + whv, v) - a - w(hD'a + ½h²K'a),
// and with more of them, each with forces and derivatives where the last one led.
// The error of K' (projected, or without a damping's derivative) in the first meets only what h²a moves.
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
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
  bool set_newton(const NewtonOptions& options) { return newton_.set(options); }

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
    const Shift shift{1 - w_.mass, now_ * w_.gamma * h, now_ * w_.beta * h * h};
    const SolveReport solved = linear_->solve_shifted(shift, v_, change_);
    if (solved.status != StepStatus::done) return solved.status;
    x_ = state.x + h * state.v + (0.5 * h * h) * a + (w_.beta * h * h) * change_;
    v_ = state.v + h * a + (w_.gamma * h) * change_;
    a_[0] = a + change_;
    const StepStatus status = newton_.improve(
        [&](V& right) {
          weighed_x_ = state.x + now_ * (x_ - state.x);
          weighed_v_ = state.v + now_ * (v_ - state.v);
          system.acceleration(weighed_x_, weighed_v_, right);
          system.linearize(weighed_x_, weighed_v_, linear_);
          right = right - (1 - w_.mass) * a_[0] - w_.mass * a;
        },
        [&](const V& right, V& change) { return linear_->solve_shifted(shift, right, change); },
        [&](const V& change) -> const V& {
          x_ = x_ + (w_.beta * h * h) * change;
          v_ = v_ + (w_.gamma * h) * change;
          return a_[0] = a_[0] + change;
        });
    if (status != StepStatus::done) return status;
    return commit(state, x_, v_, a_);
  }

 private:
  Linearization<V> linear_ = {};
  NewtonIteration<V> newton_;
  AlphaWeights w_;
  double now_;
  V x_, v_, change_;
  V weighed_x_, weighed_v_;  // between the ends of the step
  std::vector<V> a_;
};

}  // namespace springstab
