// What a method says of itself, and how its steps come from it; everything else is computed from its step.
//
// A method is a description: an object with the method's parameters, if it has any, which says `info()` and
// names a template of its steps. Explicit Euler in full:
//
//     struct MyEuler {
//       MethodInfo info() const { return {"my-euler", "my Euler", 1, false}; }
//       template <class V>
//       struct Steps {
//         template <Accelerating<V> System>
//         StepStatus step(System& system, double h, State<V>& state) {
//           system.acceleration(state.x, state.v, a);
//           x = state.x + h * state.v;
//           v = state.v + h * a;
//           return commit(state, x, v);
//         }
//         V x, v, a;
//       };
//     };
//
// One with parameters has a constructor from Parameters (parameters.h), and its name is the text it was made
// from. `step` depends on the state, on h and on the system alone: the members of Steps are workspace. What a
// method carries from step to step lies in state.memory. Optional members of Steps:
//     Steps(const MyEuler&)                        takes over the description's parameters,
//     start(system, h, state)                      fills state.memory before the first step,
//     set_newton(options)                          of implicit steps (newton.h); whether they have a use for
//     it, change_step(system, h_old, h_new, state)     turns what was carried for h_old into that for h_new.
#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "solvers/system.h"

namespace springstab {

/// What a change of h does to the vectors that a method carries.
enum class StepChange {
  nothing,  // they serve any h
  rescale,  // Steps::change_step
  restart   // Steps::start, from x and v
};

struct MethodInfo {
  std::string name;         // as typed on the command line, with the parameters if there are any
  std::string title;        // as printed in tables and figures
  int order;                // of accuracy in h
  bool implicit;            // whether a step solves a linear system
  bool linearized = false;  // an explicit method over forces frozen to a linear system (paper §4)
  int memory = 0;           // vectors carried beyond x and v
  StepChange when_h_changes = StepChange::nothing;
  bool regions_by_values = false;  // so many stages that a formula in powers of X and Y has lost its digits
  std::optional<DampingPart> implicit_damping{};  // all that it takes implicitly, if that is damping
};

template <class Description, class V>
using StepsOf = typename Description::template Steps<V>;

/// The steps of that method on vectors V, with their workspace.
template <class V, class Description>
StepsOf<Description, V> make_steps(const Description& description) {
  if constexpr (std::is_constructible_v<StepsOf<Description, V>, const Description&>) {
    return StepsOf<Description, V>(description);
  } else {
    return StepsOf<Description, V>();
  }
}

}  // namespace springstab
