// Hilber, Hughes and Taylor's method (1977), of order 2 and stable at every step for -1/3 <= α <= 0: the more
// negative α, the more it damps motions that the step does not resolve. α = 0 is Newmark's average
// acceleration.
#pragma once

#include "solvers/methods/one_step_alpha.h"
#include "solvers/methods/parameters.h"

namespace springstab {

struct HhtAlpha {
  double alpha = -0.1;
  std::string name = "hht-alpha";

  HhtAlpha() = default;
  explicit HhtAlpha(Parameters& given) : alpha(given.number("alpha", -0.1)), name(given.text()) {
    given.require(alpha > -1 && alpha < 0.5, "alpha between -1 and 0.5");
  }
  MethodInfo info() const { return {name, with_values("HHT-α", {{"α", alpha}}), 2, true, false, 1}; }

  template <class V>
  struct Steps : OneStepAlpha<V> {
    explicit Steps(const HhtAlpha& m)
        : OneStepAlpha<V>(
              {.force = -m.alpha, .beta = (1 - m.alpha) * (1 - m.alpha) / 4, .gamma = 0.5 - m.alpha}) {}
  };
};

}  // namespace springstab
