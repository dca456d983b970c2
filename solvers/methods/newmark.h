// Newmark's method (1959), β and γ as given: the acceleration over the step is one of a and a⁺.
//     newmark:beta=0.25,gamma=0.5     average acceleration, the default: stable at every step
//     newmark:rule=linear-acceleration   β = 1/6, γ = ½: h²k < 12
//     newmark:rule=central-difference    β = 0, γ = ½, with damping at both ends of the step: h²k < 4
// γ > ½ damps and is of order 1; γ < ½ amplifies.
#pragma once

#include "solvers/methods/one_step_alpha.h"
#include "solvers/methods/parameters.h"

namespace springstab {

struct Newmark {
  double beta = 0.25, gamma = 0.5;
  std::string name = "newmark";

  Newmark() = default;
  explicit Newmark(Parameters& given) : name(given.text()) {
    const std::string rule = given.word("rule", "average-acceleration");
    if (rule == "linear-acceleration") beta = 1. / 6;
    if (rule == "central-difference") beta = 0;
    given.require(
        rule == "average-acceleration" || rule == "linear-acceleration" || rule == "central-difference",
        "rule=average-acceleration, linear-acceleration or central-difference");
    beta = given.number("beta", beta);
    gamma = given.number("gamma", gamma);
    given.require(beta >= 0 && gamma >= 0, "beta and gamma that are not negative");
  }
  MethodInfo info() const {
    return {name, with_values("Newmark", {{"β", beta}, {"γ", gamma}}), gamma == 0.5 ? 2 : 1, true, false, 1};
  }

  template <class V>
  struct Steps : OneStepAlpha<V> {
    explicit Steps(const Newmark& n) : OneStepAlpha<V>({.beta = n.beta, .gamma = n.gamma}) {}
  };
};

}  // namespace springstab
