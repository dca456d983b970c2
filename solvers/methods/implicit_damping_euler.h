// Symplectic Euler, kick then drift, with a part D_i of the damping taken implicitly, as physics engines do:
//     (1 + hD_i') (v⁺ - v) = h a(x, v),   x⁺ = x + hv⁺.
//     implicit-damping-euler                 all of D, or of the matrix that the input offers for it
//     implicit-damping-euler:part=diagonal   the diagonal of that
// Of all of D further Newton steps solve v⁺ = v + ha(x, v⁺).
// One oscillator is stable exactly for Y < 4 + 2X, matrices while λ_max(h²K' + 2hD' - 4hD_i') < 4.
#pragma once

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
#include "solvers/methods/parameters.h"
#include "solvers/system.h"

namespace springstab {

struct ImplicitDampingEuler {
  DampingPart part = DampingPart::all;
  std::string name = "implicit-damping-euler";

  ImplicitDampingEuler() = default;
  explicit ImplicitDampingEuler(Parameters& given) : name(given.text()) {
    const std::string word = given.word("part", "all");
    given.require(word == "all" || word == "diagonal", "part=all or part=diagonal");
    if (word == "diagonal") part = DampingPart::diagonal;
  }
  MethodInfo info() const {
    return {.name = name,
            .title = "Euler, implicit damping",
            .order = 1,
            .implicit = true,
            .implicit_damping = part};
  }
  template <class V>
  class Steps;
};

template <class V>
class ImplicitDampingEuler::Steps {
 public:
  explicit Steps(const ImplicitDampingEuler& method) : part_(method.part) {}
  bool set_newton(const NewtonOptions& options) { return part_ == DampingPart::all && newton_.set(options); }

  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    system.acceleration(state.x, state.v, a_);
    a_ = h * a_;
    system.linearize(state.x, state.v, linear_);
    const SolveReport solved = linear_->solve_damping(part_, h, a_, v_);
    if (solved.status != StepStatus::done) return solved.status;
    v_ = state.v + v_;
    const StepStatus status = newton_.improve(
        [&](V& right) {
          system.acceleration(state.x, v_, a_);
          system.linearize(state.x, v_, linear_);
          right = state.v + h * a_ - v_;
        },
        [&](const V& right, V& change) { return linear_->solve_damping(part_, h, right, change); },
        [&](const V& change) -> const V& { return v_ = v_ + change; });
    if (status != StepStatus::done) return status;
    x_ = state.x + h * v_;
    return commit(state, x_, v_);
  }

 private:
  DampingPart part_;
  Linearization<V> linear_ = {};
  NewtonIteration<V> newton_;
  V x_, v_, a_;
};

}  // namespace springstab
