// Diagonally implicit Runge-Kutta methods with one diagonal: the tableau is the method, and its last row is
// the step (stiffly accurate). Stage i of u' = (v, a(x, v)) sits at
//     X_i = x + h Σ_{j<=i} a_ij V_j,   V_i = v + h Σ_{j<=i} a_ij f_j,
// explicit where a_ii = 0. With g = h a_ii each other stage is one Newton step from V_i = V_{i-1} (v where
// the stage before is the beginning), for Δ = V_i - V_{i-1}:
//     (1 + gD' + g²K') Δ = v + h Σ_{j<i} a_ij f_j + g a(X, V_{i-1}) - V_{i-1},   X_i = X + gΔ,
// with D' and K' of the first such stage, so that a step needs one linearization and its matrix stays. Where
// more Newton steps are asked for, each has those of its own iterate.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton.h"
#include "solvers/system.h"

namespace springstab {

template <std::size_t s>
struct DiagonallyImplicitTableau {
  static constexpr std::size_t stages = s;
  std::array<std::array<double, s>, s> a{};
};

template <class V, auto tableau>
class DiagonallyImplicit {
 public:
  bool set_newton(const NewtonOptions& options) { return newton_.set(options); }

  template <Linearizable<V> System>
  StepStatus step(System& system, double h, State<V>& state) {
    bool linearized = false;
    for (std::size_t i = 0; i < tableau.stages; ++i) {
      const double g = h * tableau.a[i][i];
      v_[i] = state.v;  // v + h Σ a_ij f_j, and what x likewise
      x_ = state.x;
      for (std::size_t j = 0; j < i; ++j) {
        if (tableau.a[i][j] == 0) continue;
        x_ = x_ + (h * tableau.a[i][j]) * v_[j];
        v_[i] = v_[i] + (h * tableau.a[i][j]) * f_[j];
      }
      if (g == 0) {
        system.acceleration(x_, v_[i], f_[i]);
        continue;
      }
      const V& from = i == 0 ? state.v : v_[i - 1];
      x_ = x_ + g * from;
      system.acceleration(x_, from, f_[i]);
      if (!linearized) system.linearize(x_, from, linear_);
      linearized = true;
      right_ = v_[i] - from + g * f_[i];
      const SolveReport solved = linear_->solve_shifted({1, g, g * g}, right_, change_);
      if (solved.status != StepStatus::done) return solved.status;
      x_ = x_ + g * change_;
      u_ = from + change_;
      const StepStatus status = newton_.improve(
          [&](V& right) {
            system.acceleration(x_, u_, f_[i]);
            system.linearize(x_, u_, linear_);
            right = v_[i] + g * f_[i] - u_;
          },
          [&](const V& right, V& change) {
            return linear_->solve_shifted({1, g, g * g}, right, change);
          },
          [&](const V& change) -> const V& {
            x_ = x_ + g * change;
            return u_ = u_ + change;
          });
      if (status != StepStatus::done) return status;
      f_[i] = (1 / g) * (u_ - v_[i]);
      std::swap(v_[i], u_);
    }
    return commit(state, x_, v_.back());
  }

 private:
  Linearization<V> linear_ = {};
  NewtonIteration<V> newton_;
  std::array<V, tableau.stages> v_, f_;
  V x_, right_, change_, u_;
};

}  // namespace springstab
