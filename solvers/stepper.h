// The methods by name, for systems chosen at run time.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "solvers/methods/method_info.h"
#include "solvers/system.h"

namespace springstab {

/// A method with its workspace; not to be shared between threads. The first step allocates, later ones do
/// not.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Advances the state by h, or says why it did not and leaves the state as it was.
  virtual StepStatus step(System& system, double h, State<Vector>& state) = 0;
  /// Drops what is kept from step to step (a linearization), as after going back to an earlier state. In a
  /// linearized method one linearization serves `steps_per_linearization` >= 1 steps from now on; the others
  /// have no use for the number.
  virtual void restart(long steps_per_linearization) = 0;
};

/// All methods, in the order of the list.
std::span<const MethodInfo> all_methods();

/// The method of that name; throws std::invalid_argument that lists the known names.
const MethodInfo& find_method(std::string_view name);

/// A stepper for the method of that name; throws like find_method. A linearized method linearizes at every
/// step until it is told otherwise.
std::unique_ptr<Stepper> make_stepper(std::string_view name);

}  // namespace springstab
