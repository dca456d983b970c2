#include "analysis/spectra/transition_operator.h"

#include <memory>
#include <stdexcept>
#include <string>

namespace springstab {

LinearOperator transition_operator(LinearSystem& system, const Method& method, double h) {
  const std::shared_ptr<Stepper> stepper = method.stepper();
  const Eigen::Index n = system.size(), m = method.size();
  State<Vector> state;
  state.memory.resize(static_cast<std::size_t>(m - 2));
  return {m * n, [&system, stepper, h, n, state](const Vector& in, Vector& out) mutable {
            state.x = in.head(n);
            state.v = in.segment(n, n);
            for (std::size_t i = 0; i < state.memory.size(); ++i)
              state.memory[i] = in.segment((2 + static_cast<Eigen::Index>(i)) * n, n);
            if (stepper->step(system, h, state) != StepStatus::done)
              throw std::runtime_error("the step failed with h = " + std::to_string(h));
            out.resize(in.size());
            out.head(n) = state.x;
            out.segment(n, n) = state.v;
            for (std::size_t i = 0; i < state.memory.size(); ++i)
              out.segment((2 + static_cast<Eigen::Index>(i)) * n, n) = state.memory[i];
          }};
}

}  // namespace springstab
