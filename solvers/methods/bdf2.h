// The backward differentiation formula of order 2, which carries the state before, u₋ = (x₋, v₋):
//     u⁺ = (4u - u₋)/3 + (2h/3) u'⁺,   u' = (v, a(x, v)),
// with one Newton step from v⁺ = 2v - v₋, for Δ = v⁺ less that, g = 2h/3 and forces and derivatives there:
//     (1 + gD' + g²K') Δ = (4v - v₋)/3 + g a - (2v - v₋),
// or with as many as are asked for.
// The state before the first one is chosen so that the first step is one of implicit Euler, whose error in a
// single step does not lower the order.
#pragma once

#include "solvers/methods/implicit_euler.h"
#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
#include "solvers/system.h"

namespace springstab {

struct Bdf2 {
  MethodInfo info() const { return {"bdf2", "BDF2", 2, true, false, 2, StepChange::restart}; }
  template <class V>
  class Steps;
};

template <class V>
class Bdf2::Steps {
 public:
  bool set_newton(const NewtonOptions& options) { return first_.set_newton(options) && newton_.set(options); }

  template <Linearizable<V> System>
  void start(System& system, double h, State<V>& state) {
    State<V> next{state.x, state.v};
    if (first_.step(system, h, next) != StepStatus::done)
      next.x = state.x + h * state.v;  // the step will fail
    state.memory[0] = 2.0 * state.x - next.x;
    state.memory[1] = 2.0 * state.v - next.v;
  }

  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    before_.resize(2);
    const double g = 2 * h / 3;
    v_ = 2.0 * state.v - state.memory[1];
    x_ = (4. / 3) * state.x - (1. / 3) * state.memory[0] + g * v_;
    system.acceleration(x_, v_, a_);
    system.linearize(x_, v_, linear_);
    a_ = (4. / 3) * state.v - (1. / 3) * state.memory[1] + g * a_ - v_;
    const SolveReport solved = linear_->solve_shifted({1, g, g * g}, a_, change_);
    if (solved.status != StepStatus::done) return solved.status;
    x_ = x_ + g * change_;
    v_ = v_ + change_;
    const StepStatus status = newton_.improve(
        [&](V& right) {
          system.acceleration(x_, v_, a_);
          system.linearize(x_, v_, linear_);
          right = (4. / 3) * state.v - (1. / 3) * state.memory[1] + g * a_ - v_;
        },
        [&](const V& right, V& change) {
          return linear_->solve_shifted({1, g, g * g}, right, change);
        },
        [&](const V& change) -> const V& {
          x_ = x_ + g * change;
          return v_ = v_ + change;
        });
    if (status != StepStatus::done) return status;
    before_[0] = state.x;
    before_[1] = state.v;
    return commit(state, x_, v_, before_);
  }

 private:
  ImplicitEuler::Steps<V> first_;
  Linearization<V> linear_ = {};
  NewtonIteration<V> newton_;
  V x_, v_, a_, change_;
  std::vector<V> before_;
};

}  // namespace springstab
