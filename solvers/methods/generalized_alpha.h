// The generalized-α method (Chung and Hulbert 1993), of order 2: ρ∞ is the spectral radius it tends to as
// h²k grows, 1 for no damping, 0 for all of it. Stable at every step for -1 < ρ∞ <= 1; ρ∞ > 1 amplifies.
#pragma once

#include "solvers/methods/one_step_alpha.h"
#include "solvers/methods/parameters.h"

namespace springstab {

struct GeneralizedAlpha {
  double rho = 0.8;
  std::string name = "generalized-alpha";

  GeneralizedAlpha() = default;
  explicit GeneralizedAlpha(Parameters& given) : rho(given.number("rho", 0.8)), name(given.text()) {
    given.require(rho > -1 && rho < 2, "rho between -1 and 2");
  }
  MethodInfo info() const { return {name, with_values("generalized-α", {{"ρ∞", rho}}), 2, true, false, 1}; }

  AlphaWeights weights() const {
    const double mass = (2 * rho - 1) / (rho + 1), force = rho / (rho + 1), shift = 1 - mass + force;
    return {mass, force, shift * shift / 4, 0.5 - mass + force};
  }
  template <class V>
  struct Steps : OneStepAlpha<V> {
    explicit Steps(const GeneralizedAlpha& m) : OneStepAlpha<V>(m.weights()) {}
  };
};

}  // namespace springstab
