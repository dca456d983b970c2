// A described method at work on systems that are chosen at run time:
//
//     const auto stepper = make_stepper(Rk4());
//     stepper->start(system, h, state);
//     while (time < end && stepper->step(system, h, state) == StepStatus::done) time += h;
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
#include "solvers/system.h"

namespace springstab {

/// Whether the kinetic energy [J] of the state after so many steps (1, ...) raises no doubt; it may be off by
/// rounding.
using Plausible = std::function<bool(long step, double kinetic_energy)>;

/// A method with its workspace; not to be shared between threads. The first step allocates, later ones do
/// not.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Makes state.memory what the method carries, for steps of h from here on.
  virtual void start(System& system, double h, State<Vector>& state) = 0;
  /// Advances the state by h, or says why it did not and leaves the state as it was.
  virtual StepStatus step(System& system, double h, State<Vector>& state) = 0;
  /// Takes several steps of h, `most` or fewer, together where the method has a way to, which is faster than
  /// and to the same bits as one by one, and returns how many. None, and the state is as it was, where it has
  /// not, or a state on the way is not finite or not plausible. The last is for the caller to look at.
  virtual long take_steps(System& system, double h, long most, State<Vector>& state,
                          const Plausible& plausible) = 0;
  /// After steps of h_old, before the first of h_new: what is carried serves that.
  virtual void change_step(System& system, double h_old, double h_new, State<Vector>& state) = 0;
  /// Drops what is kept from step to step (a linearization), as after going back to an earlier state. In a
  /// linearized method one linearization serves `steps_per_linearization` >= 1 steps from now on; the others
  /// have no use for the number.
  virtual void restart(long steps_per_linearization) = 0;
  /// How many Newton steps an implicit step takes from now on. Whether the method has a use for that.
  virtual bool set_newton(const NewtonOptions& options) = 0;
};

/// Makes state.memory the `memory` vectors that the steps carry from this x and v on.
template <class Steps, class AnySystem, class V>
void start_steps(Steps& steps, int memory, AnySystem& system, double h, State<V>& state) {
  state.memory.resize(static_cast<std::size_t>(memory));
  if constexpr (requires { steps.start(system, h, state); }) steps.start(system, h, state);
}

template <class Description>
class StepperOf final : public Stepper {
 public:
  explicit StepperOf(const Description& description)
      : info_(description.info()), steps_(make_steps<Vector>(description)) {
    constexpr bool starts = requires(Steps & s, System & y, State<Vector> & x) { s.start(y, 1.0, x); };
    if (info_.memory < 0 || (info_.memory > 0 && !starts))
      throw std::invalid_argument("method '" + info_.name + "' carries " + std::to_string(info_.memory) +
                                  " vectors, expected none or a start() that fills them");
    if (info_.when_h_changes == StepChange::rescale && !rescales)
      throw std::invalid_argument("method '" + info_.name + "' rescales, expected a change_step()");
  }

  void start(System& system, double h, State<Vector>& state) override {
    start_steps(steps_, info_.memory, system, h, state);
  }
  StepStatus step(System& system, double h, State<Vector>& state) override {
    return steps_.step(system, h, state);
  }
  long take_steps(System& system, double h, long most, State<Vector>& state,
                  const Plausible& plausible) override {
    if constexpr (requires(Steps & s) { s.take_steps(system, h, most, state, plausible); })
      return steps_.take_steps(system, h, most, state, plausible);
    return 0;
  }
  void change_step(System& system, double h_old, double h_new, State<Vector>& state) override {
    if (info_.when_h_changes == StepChange::restart) start(system, h_new, state);
    if constexpr (rescales)
      if (info_.when_h_changes == StepChange::rescale) steps_.change_step(system, h_old, h_new, state);
  }
  void restart(long steps_per_linearization) override {
    if constexpr (requires(Steps & s) { s.restart(1L); }) steps_.restart(steps_per_linearization);
  }
  bool set_newton(const NewtonOptions& options) override {
    if constexpr (requires(Steps & s) { s.set_newton(options); }) {
      return steps_.set_newton(options);
    } else {
      return false;
    }
  }

 private:
  using Steps = StepsOf<Description, Vector>;
  static constexpr bool rescales = requires(Steps & s, System& y, State<Vector>& x) {
    s.change_step(y, 1.0, 1.0, x);
  };

  MethodInfo info_;
  Steps steps_;
};

/// A stepper for the method. A linearized method linearizes at every step until it is told otherwise. Throws
/// std::invalid_argument for a description that says it carries or rescales what its steps do not.
template <class Description>
std::unique_ptr<Stepper> make_stepper(const Description& description) {
  return std::make_unique<StepperOf<Description>>(description);
}

}  // namespace springstab
