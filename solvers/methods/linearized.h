// Linearized explicit methods (paper §4): an explicit method over the frozen linear system
//     a(x, v) = a0 - K'(x - x0) - D'(v - v0)   (Eq. 34 divided by M),
// with K, D and a0 = a(x0, v0) taken anew at the state where a linearization begins. With Rayleigh damping a
// stage costs one block product. A linearization serves `steps_per_linearization` steps; with 1, a step
// depends on the state alone. Steps that one linearization serves may go through it together.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "solvers/methods/explicit_euler.h"
#include "solvers/methods/rk4.h"
#include "solvers/system.h"

namespace springstab {

template <class Inner, class V>
class Linearized {
 public:
  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    if (steps_left_ == 0) freeze(system, state);
    const StepStatus status = inner_.step(frozen_, h, state);
    steps_left_ = status == StepStatus::done ? steps_left_ - 1 : 0;
    return status;
  }

  /// See Stepper.
  template <Linearizable<V> System, class Plausible>
  requires requires { typename StepsOf<Inner, V>::ByRows; }
  long take_steps(System& system, double h, long most, State<V>& state, const Plausible& plausible) {
    using ByRows = typename StepsOf<Inner, V>::ByRows;
    if (std::min(most, steps_left_ == 0 ? steps_per_linearization_ : steps_left_) < 2) return 0;
    if (steps_left_ == 0) freeze(system, state);
    const long wanted = std::min(most, steps_left_),
               at_once = frozen_.linear->steps_at_once(ByRows::all_stages);
    if (at_once < 2) return 0;
    const long passes = (wanted + at_once - 1) / at_once, steps = (wanted + passes - 1) / passes;
    before_.x = state.x;
    before_.v = state.v;
    Together<ByRows, Plausible> together(*this, h, state, steps, plausible);
    if (!frozen_.linear->take_steps(steps, together)) {
      exchange(state.x, before_.x);
      exchange(state.v, before_.v);
      return 0;
    }
    steps_left_ -= steps;
    return steps;
  }

  /// The next step linearizes anew, as after a divergence (paper §4, step 2.3), and so does every
  /// `steps_per_linearization`-th from there.
  void restart(long steps_per_linearization) {
    if (steps_per_linearization < 1)
      throw std::invalid_argument("a linearization must serve at least one step");
    steps_per_linearization_ = steps_per_linearization;
    steps_left_ = 0;
  }

 private:
  static constexpr auto all = [](auto& u) -> auto& { return u; };

  // The linear system plus what the forces have beyond it at the point of linearization.
  struct Frozen {
    Linearization<V> linear = {};
    V constant;

    void acceleration(const V& x, const V& v, V& a) {
      linear->acceleration(x, v, a);
      add_constant(a, all);
    }
    template <class Part>
    void add_constant(V& a, const Part& part) const {
      part(a) = part(a) + part(constant);
    }
  };

  // Steps of the method over the frozen system, which has no constant, by rows.
  template <class ByRows, class Plausible>
  class Together final : public ByRows {
   public:
    Together(Linearized& steps, double h, State<V>& state, long count, const Plausible& plausible)
        : ByRows(steps.inner_, h, state),
          frozen_(steps.frozen_),
          state_(state),
          steps_(count),
          plausible_(plausible) {}

    void advance(int stage, const IndexRange& unknowns) override {
      frozen_.add_constant(this->acceleration(stage), entries(unknowns));
      ByRows::advance(stage, unknowns);
    }
    // What is not finite stays so, and whoever asked for the steps looks at the last of them.
    bool accept(double kinetic_energy) override {
      if (++step_ < steps_) return plausible_(step_, kinetic_energy);
      return all_finite(state_.x) && all_finite(state_.v);
    }

   private:
    const Frozen& frozen_;
    const State<V>& state_;
    long step_ = 0, steps_;
    const Plausible& plausible_;
  };

  template <class System>
  void freeze(System& system, const State<V>& state) {
    system.acceleration(state.x, state.v, frozen_.constant);
    system.linearize(state.x, state.v, frozen_.linear);
    frozen_.linear->acceleration(state.x, state.v, work_);
    frozen_.constant = frozen_.constant - work_;
    steps_left_ = steps_per_linearization_;
  }

  StepsOf<Inner, V> inner_ = make_steps<V>(Inner());
  Frozen frozen_;
  V work_;
  State<V> before_;  // the steps that are taken together
  long steps_per_linearization_ = 1;
  long steps_left_ = 0;  // that the linearization at hand serves
};

struct LinearizedExplicitEuler {
  MethodInfo info() const {
    return {"linearized-explicit-euler", "linearized explicit Euler", 1, false, true};
  }
  template <class V>
  using Steps = Linearized<ExplicitEuler, V>;
};

/// Of order 2, since K and D do not follow the state within a step, and 1 where D depends on x.
struct LinearizedRk4 {
  MethodInfo info() const { return {"linearized-rk4", "linearized Runge-Kutta 4", 2, false, true}; }
  template <class V>
  using Steps = Linearized<Rk4, V>;
};

}  // namespace springstab
