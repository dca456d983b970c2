// A method that is a tableau given at run time (tableau.h), explicit or implicit: one step for all of them.
//
//     const Method mine = method_of({"kutta3", "Kutta 3"}, runge_kutta(a, b));   // method_of_coefficients.h
//
// Stages that depend on themselves are solved one after the other (newton_stage.h), from the velocity of the
// stage before; those that depend on later ones all together, (1 + hâ ⊗ D' + h²ā ⊗ K') F = ..., from f = 0.
// Each Newton step with one linearization is worth two orders, so that there are half as many as the order.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solvers/methods/method_info.h"
#include "solvers/methods/newton_stage.h"
#include "solvers/methods/tableau.h"

namespace springstab {

template <bool solves>
struct TableauMethod {
  std::string name, title;
  StageTableau tableau;
  int order;

  TableauMethod(std::string its_name, std::string its_title, const StageTableau& given)
      : name(std::move(its_name)),
        title(std::move(its_title)),
        tableau(without_idle_stages(given)),
        order(order_of(given)) {}

  MethodInfo info() const {
    const bool many = tableau.c.size() > (kind_of(tableau) == StageKind::fully_implicit ? 3 : 8);
    return {.name = name, .title = title, .order = order, .implicit = solves, .regions_by_values = many};
  }
  template <class V>
  class Steps;
};

template <bool solves>
template <class V>
class TableauMethod<solves>::Steps {
 public:
  explicit Steps(const TableauMethod& method)
      : t_(method.tableau),
        coupled_(kind_of(t_) == StageKind::fully_implicit),
        passes_((method.order + 1) / 2),
        f_(static_cast<std::size_t>(t_.c.size())),
        change_(f_.size()),
        rest_(f_.size()) {}

  template <Accelerating<V> System>
  requires(!solves || Linearizable<System, V>) StepStatus step(System& system, double h, State<V>& state) {
    const StepStatus status = evaluate_stages(system, h, state);
    if (status != StepStatus::done) return status;
    x_ = state.x + h * state.v;
    v_ = state.v;
    for (Eigen::Index i = 0; i < t_.c.size(); ++i) {
      add(h * h * t_.position_weights[i], i, x_);
      add(h * t_.velocity_weights[i], i, v_);
    }
    return commit(state, x_, v_);
  }

 private:
  template <class System>
  StepStatus evaluate_stages(System& system, double h, const State<V>& state) {
    if constexpr (solves) {
      if (coupled_) return solve_together(system, h, state);
      newton_.begin();
      from_ = state.v;
    }
    for (Eigen::Index i = 0; i < t_.c.size(); ++i) {
      move_to_stage(h, i, i, state);
      V& f = f_[static_cast<std::size_t>(i)];
      const double g = h * t_.velocity(i, i), q = h * h * t_.position(i, i);
      if constexpr (solves) {
        if (g != 0 || q != 0) {
          if (g != 0) {
            f = (1 / g) * (from_ - v_);
          } else {
            f = 0.0 * state.v;
          }
          const StepStatus status = newton_.solve(system, g, q, passes_, x_, v_, f);
          if (status != StepStatus::done) return status;
          from_ = v_;
          continue;
        }
        from_ = v_;
      }
      system.acceleration(x_, v_, f);
    }
    return StepStatus::done;
  }

  template <class System>
  StepStatus solve_together(System& system, double h, const State<V>& state) {
    system.linearize(state.x, state.v, linear_);
    const StageCoupling coupling{h * t_.velocity, h * h * t_.position};
    const int passes = Linear<System, V> ? 1 : passes_;
    for (int pass = 0; pass < passes; ++pass) {
      for (Eigen::Index i = 0; i < t_.c.size(); ++i) {
        const auto stage = static_cast<std::size_t>(i);
        move_to_stage(h, i, pass == 0 ? 0 : t_.c.size(), state);
        system.acceleration(x_, v_, rest_[stage]);
        if (pass > 0) rest_[stage] = rest_[stage] - f_[stage];
      }
      const SolveReport solved = linear_->solve_coupled(coupling, rest_, pass == 0 ? f_ : change_);
      if (solved.status != StepStatus::done) return solved.status;
      if (pass > 0)
        for (std::size_t i = 0; i < f_.size(); ++i) f_[i] = f_[i] + change_[i];
    }
    return StepStatus::done;
  }

  // X_i, V_i with the stages before `end`.
  void move_to_stage(double h, Eigen::Index i, Eigen::Index end, const State<V>& state) {
    x_ = state.x;
    if (t_.c[i] != 0) x_ = x_ + (h * t_.c[i]) * state.v;
    v_ = state.v;
    for (Eigen::Index j = 0; j < end; ++j) {
      add(h * h * t_.position(i, j), j, x_);
      add(h * t_.velocity(i, j), j, v_);
    }
  }

  void add(double weight, Eigen::Index stage, V& sum) const {
    if (weight != 0) sum = sum + weight * f_[static_cast<std::size_t>(stage)];
  }

  StageTableau t_;
  bool coupled_;
  int passes_;
  std::vector<V> f_, change_, rest_;
  NewtonStage<V> newton_;
  Linearization<V> linear_ = {};
  V x_, v_, from_;
};

}  // namespace springstab
