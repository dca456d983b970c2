// Linearized explicit methods (paper §4): an explicit method over the frozen linear system
//     a(x, v) = a0 - K'(x - x0) - D'(v - v0)   (Eq. 34 divided by M),
// with K, D and a0 = a(x0, v0) taken anew at the state where a linearization begins. With Rayleigh damping a
// stage costs one block product. A linearization serves `steps_per_linearization` steps; with 1, a step
// depends on the state alone.
#pragma once

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
    if (steps_ == 0) freeze(system, state);
    const StepStatus status = inner_.step(frozen_, h, state);
    if (status == StepStatus::done) steps_ = (steps_ + 1) % steps_per_linearization_;
    return status;
  }

  /// The next step linearizes anew, as after a divergence (paper §4, step 2.3), and so does every
  /// `steps_per_linearization`-th from there.
  void restart(long steps_per_linearization) {
    if (steps_per_linearization < 1)
      throw std::invalid_argument("a linearization must serve at least one step");
    steps_per_linearization_ = steps_per_linearization;
    steps_ = 0;
  }

 private:
  // The linear system plus what the forces have beyond it at the point of linearization.
  struct Frozen {
    Linearization<V> linear = {};
    V constant;

    void acceleration(const V& x, const V& v, V& a) {
      linear->acceleration(x, v, a);
      a = a + constant;
    }
  };

  template <class System>
  void freeze(System& system, const State<V>& state) {
    system.acceleration(state.x, state.v, frozen_.constant);
    system.linearize(state.x, state.v, frozen_.linear);
    frozen_.linear->acceleration(state.x, state.v, work_);
    frozen_.constant = frozen_.constant - work_;
  }

  StepsOf<Inner, V> inner_ = make_steps<V>(Inner());
  Frozen frozen_;
  V work_;
  long steps_per_linearization_ = 1;
  long steps_ = 0;
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
