#include "analysis/spectra/transition_operator.h"

#include <stdexcept>
#include <string>

#include "solvers/stepper.h"

namespace springstab {

LinearOperator transition_operator(LinearSystem& system, std::string_view method, double h) {
  const std::shared_ptr<Stepper> stepper = make_stepper(method);
  const Eigen::Index n = system.size();
  return {2 * n, [&system, stepper, h, n, state = State<Vector>()](const Vector& in, Vector& out) mutable {
            state.x = in.head(n);
            state.v = in.tail(n);
            if (stepper->step(system, h, state) != StepStatus::done)
              throw std::runtime_error("the step failed with h = " + std::to_string(h));
            out.resize(2 * n);
            out << state.x, state.v;
          }};
}

}  // namespace springstab
