// A linear multistep method given at run time (multistep.h). It carries what its formula asks for of the
// k - 1 states before: x where an α of theirs is not zero or the form is of second order, v in the
// first-order form, a where a β or δ is not zero; each from the youngest to the oldest.
//
// An implicit one takes one Newton step from the polynomial through the velocities it has, or in the
// second-order form one for every two orders from the last velocity. The states before the first are made so
// that the order p stays: of explicit methods by RK4 backwards, of implicit ones by the polynomial through
// u_0 and p - 1 steps forward of implicit Euler extrapolated to order p - 1, which stay bounded at any step.
// (In the second-order form, where the first difference of x is a velocity, p of them.)
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "solvers/methods/implicit_euler.h"
#include "solvers/methods/method_info.h"
#include "solvers/methods/multistep.h"
#include "solvers/methods/newton_stage.h"
#include "solvers/methods/rk4.h"

namespace springstab {

template <bool solves>
struct MultistepMethod {
  static constexpr int order_of_start = 4;  // of the states before the first, less one power of h

  std::string name, title;
  Multistep formula;
  int order;
  bool carries_x, carries_v, carries_a;

  MultistepMethod(std::string its_name, std::string its_title, const Multistep& given)
      : name(std::move(its_name)),
        title(std::move(its_title)),
        formula(given),
        order(std::min(order_of(given), order_of_start + (given.second_order ? 0 : 1))) {
    const double leading = formula.alpha.back();
    for (double& a : formula.alpha) a /= leading;
    for (double& b : formula.beta) b /= leading;
    const auto earlier = [&](const std::vector<double>& w) {
      return std::any_of(w.begin(), w.begin() + static_cast<std::ptrdiff_t>(formula.steps()) - 1,
                         [](double c) { return c != 0; });
    };
    carries_x = formula.second_order || earlier(formula.alpha);
    carries_v = !formula.second_order;
    carries_a = earlier(formula.beta) || (formula.second_order && earlier(formula.velocity_of_a));
  }

  std::size_t before() const { return formula.steps() - 1; }
  MethodInfo info() const {
    const int memory = static_cast<int>(before()) * (carries_x + carries_v + carries_a);
    return {.name = name,
            .title = title,
            .order = order,
            .implicit = solves,
            .memory = memory,
            .when_h_changes = memory > 0 ? StepChange::restart : StepChange::nothing};
  }
  template <class V>
  class Steps;
};

template <bool solves>
template <class V>
class MultistepMethod<solves>::Steps {
 public:
  explicit Steps(const MultistepMethod& method)
      : m_(method),
        needs_a_(has_now(m_.formula.beta) || (m_.formula.second_order && has_now(m_.formula.velocity_of_a)) ||
                 m_.carries_a) {}

  template <Accelerating<V> System>
  requires(!solves || Linearizable<System, V>) void start(System& system, double h, State<V>& state) {
    State<V> earlier{state.x, state.v};
    if constexpr (solves) step_forward(system, h, state);
    for (std::size_t j = 0; j < m_.before(); ++j) {
      step_back(system, h, j, earlier);
      std::size_t at = j;
      const auto keep = [&](bool carried, const V& u) {
        if (carried) state.memory[std::exchange(at, at + m_.before())] = u;
      };
      keep(m_.carries_x, earlier.x);
      keep(m_.carries_v, earlier.v);
      if (m_.carries_a) system.acceleration(earlier.x, earlier.v, a_);
      keep(m_.carries_a, a_);
    }
  }

  template <Accelerating<V> System>
  requires(!solves || Linearizable<System, V>) StepStatus step(System& system, double h, State<V>& state) {
    if (needs_a_) system.acceleration(state.x, state.v, a_);
    set_base(h, state);
    if constexpr (solves) {
      const StepStatus status = solve(system, h, state);
      if (status != StepStatus::done) return status;
    }
    if (m_.before() == 0) return commit(state, x_, v_);
    before_.resize(state.memory.size());
    std::size_t at = 0;
    const auto shift = [&](bool carried, const V& newest) {
      if (!carried) return;
      for (std::size_t j = m_.before() - 1; j > 0; --j) before_[at + j] = state.memory[at + j - 1];
      before_[at] = newest;
      at += m_.before();
    };
    shift(m_.carries_x, state.x);
    shift(m_.carries_v, state.v);
    shift(m_.carries_a, a_);
    return commit(state, x_, v_, before_);
  }

 private:
  bool has_now(const std::vector<double>& w) const { return w[w.size() - 2] != 0; }

  // Of the state j steps before the one that the step begins with: what coefficient j + 1 from the end meets.
  const V& x(const State<V>& s, std::size_t j) const { return j == 0 ? s.x : s.memory[j - 1]; }
  const V& v(const State<V>& s, std::size_t j) const {
    return j == 0 ? s.v : s.memory[m_.carries_x * m_.before() + j - 1];
  }
  const V& a(const State<V>& s, std::size_t j) const {
    return j == 0 ? a_ : s.memory[(m_.carries_x + m_.carries_v) * m_.before() + j - 1];
  }

  // x⁺ and v⁺ but for what the new acceleration gives.
  void set_base(double h, const State<V>& s) {
    const Multistep& f = m_.formula;
    const std::size_t k = f.steps();
    x_ = -f.alpha[k - 1] * s.x;
    for (std::size_t j = 1; j < k; ++j)
      if (const double w = f.alpha[k - 1 - j]; w != 0) x_ = x_ - w * x(s, j);
    if (f.second_order) {
      for (std::size_t j = 0; j < k; ++j)
        if (const double w = f.beta[k - 1 - j]; w != 0) x_ = x_ + (h * h * w) * a(s, j);
      v_ = (f.velocity_of_x[k] / h) * x_;
      for (std::size_t j = 0; j < k; ++j) {
        if (const double w = f.velocity_of_x[k - 1 - j]; w != 0) v_ = v_ + (w / h) * x(s, j);
        if (const double w = f.velocity_of_a[k - 1 - j]; w != 0) v_ = v_ + (h * w) * a(s, j);
      }
      return;
    }
    v_ = -f.alpha[k - 1] * s.v;
    for (std::size_t j = 0; j < k; ++j) {
      if (const double w = f.alpha[k - 1 - j]; j > 0 && w != 0) v_ = v_ - w * v(s, j);
      if (const double w = f.beta[k - 1 - j]; w != 0) {
        x_ = x_ + (h * w) * v(s, j);
        v_ = v_ + (h * w) * a(s, j);
      }
    }
    x_ = x_ + (h * f.beta[k]) * v_;
  }

  template <class System>
  StepStatus solve(System& system, double h, const State<V>& s) {
    const Multistep& f = m_.formula;
    const double b = h * f.beta.back(), q = f.second_order ? h * b : b * b,
                 g = f.second_order ? f.velocity_of_x.back() * b + h * f.velocity_of_a.back() : b;
    if (g != 0) {
      expected_v(s);
      f_ = (1 / g) * (f_ - v_);
    } else {
      f_ = (1 / q) * (s.x + h * s.v - x_);
    }
    newton_.begin();
    return newton_.solve(system, g, q, f.second_order ? (m_.order + 1) / 2 : 1, x_, v_, f_);
  }

  // f_ = the velocity to come by the polynomial through those there are, Σ (-1)^j C(n, j + 1) v_j.
  void expected_v(const State<V>& s) {
    const std::size_t n = m_.carries_v ? m_.formula.steps() : 1;
    double w = static_cast<double>(n);
    f_ = w * s.v;
    for (std::size_t j = 1; j < n; ++j) {
      w *= -static_cast<double>(n - j) / static_cast<double>(j + 1);
      f_ = f_ + w * v(s, j);
    }
  }

  // `forward_`: the state and the steps from it.
  template <class System>
  void step_forward(System& system, double h, const State<V>& state) {
    const int degree = std::max(1, m_.order - (m_.formula.second_order ? 0 : 1));
    forward_.assign(1, {state.x, state.v});
    for (int i = 0; i < degree; ++i) {
      const State<V> from = forward_.back();
      State<V> sum{0.0 * from.x, 0.0 * from.v};
      for (int n = 1; n <= degree; ++n) {
        State<V> to{from.x, from.v};
        ImplicitEuler::Steps<V> euler;
        for (int l = 0; l < n; ++l)
          if (euler.step(system, h / n, to) != StepStatus::done)
            to.x = to.x + (h / n) * to.v;  // so will ours
        double w = 1;
        for (int other = 1; other <= degree; ++other)
          if (other != n) w *= static_cast<double>(n) / (n - other);
        sum.x = sum.x + w * to.x;
        sum.v = sum.v + w * to.v;
      }
      forward_.push_back(std::move(sum));
    }
  }

  // `earlier` one step further back, to j + 1 steps before the state.
  template <class System>
  void step_back(System& system, double h, std::size_t j, State<V>& earlier) {
    if constexpr (solves) {
      earlier.x = 0.0 * earlier.x;
      earlier.v = 0.0 * earlier.v;
      const auto t = -static_cast<double>(j + 1);
      for (std::size_t i = 0; i < forward_.size(); ++i) {
        double w = 1;  // Lagrange's polynomial i at t
        for (std::size_t l = 0; l < forward_.size(); ++l)
          if (l != i) w *= (t - static_cast<double>(l)) / (static_cast<double>(i) - static_cast<double>(l));
        earlier.x = earlier.x + w * forward_[i].x;
        earlier.v = earlier.v + w * forward_[i].v;
      }
    } else if (Rk4::Steps<V> rk4; rk4.step(system, -h, earlier) != StepStatus::done) {
      earlier.x = earlier.x - h * earlier.v;  // the first step will fail, too
    }
  }

  MultistepMethod m_;
  bool needs_a_;
  NewtonStage<V> newton_;
  std::vector<V> before_;
  std::vector<State<V>> forward_;
  V x_, v_, a_, f_;
};

}  // namespace springstab
