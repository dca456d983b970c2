// The Runge-Kutta-Chebyshev method of order 2 with s stages (Sommeijer, Shampine and Verwer 1998), an
// explicit method for strong damping: stable on the real axis to about 0.65 s², on the imaginary axis not at
// all. Stages of u' = (v, a(x, v)) by the recurrence of the Chebyshev polynomials T_j, ε = 2/13:
//     U_0 = u,   U_1 = u + μ̃_1 h u',
//     U_j = (1 - μ_j - ν_j) u + μ_j U_{j-1} + ν_j U_{j-2} + μ̃_j h U'_{j-1} + γ̃_j h u'.
#pragma once

#include <vector>

#include "solvers/methods/method_info.h"
#include "solvers/methods/parameters.h"
#include "solvers/system.h"

namespace springstab {

struct Rkc2 {
  long stages = 5;
  std::string name = "rkc2";

  Rkc2() = default;
  explicit Rkc2(Parameters& given) : stages(given.count("stages", 5)), name(given.text()) {
    given.require(stages >= 2 && stages <= 200, "between 2 and 200 stages");
  }
  MethodInfo info() const {
    return {.name = name,
            .title = with_values("RKC2", {{"s", static_cast<double>(stages)}}),
            .order = 2,
            .implicit = false,
            .regions_by_values = stages > 3};
  }

  struct Stage {
    double mu, nu, mu_rate, gamma_rate;  // μ, ν, μ̃, γ̃
  };
  std::vector<Stage> coefficients() const;  // of stages 1 ... s

  template <class V>
  class Steps;
};

template <class V>
class Rkc2::Steps {
 public:
  explicit Steps(const Rkc2& method) : stages_(method.coefficients()) {}

  template <Accelerating<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    system.acceleration(state.x, state.v, first_);
    const double begin = h * stages_[0].mu_rate;
    x2_ = state.x, v2_ = state.v;
    x1_ = state.x + begin * state.v, v1_ = state.v + begin * first_;
    for (std::size_t j = 1; j < stages_.size(); ++j) {
      const auto& [mu, nu, mu_rate, gamma_rate] = stages_[j];
      system.acceleration(x1_, v1_, a_);
      x2_ = (1 - mu - nu) * state.x + mu * x1_ + nu * x2_ + (h * mu_rate) * v1_ + (h * gamma_rate) * state.v;
      v2_ = (1 - mu - nu) * state.v + mu * v1_ + nu * v2_ + (h * mu_rate) * a_ + (h * gamma_rate) * first_;
      std::swap(x1_, x2_);
      std::swap(v1_, v2_);
    }
    return commit(state, x1_, v1_);
  }

 private:
  std::vector<Stage> stages_;
  V x1_, v1_, x2_, v2_, a_, first_;  // the last stage, the one before, rates
};

}  // namespace springstab
