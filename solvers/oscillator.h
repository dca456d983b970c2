// One oscillator x'' = -k x - d v, or several side by side: the scalar mode on which a method's
// stability is decided. Everything is elementwise, so V may be a double, an array of oscillators,
// or a symbol that records the formula.
#pragma once

#include <cstddef>
#include <vector>

#include "solvers/system.h"

namespace springstab {

/// Stiffness k [1/s²] and damping d [1/s] per unit mass, of the same shape as the state's x and v.
/// With a step h = 1 they are the paper's Y = h²k and X = hd (Eq. 21).
template <class V>
struct Oscillator {
  V k;
  V d;

  void acceleration(const V& x, const V& v, V& a) const { a = -(k * x) - d * v; }
  void stiffness_times(const V& u, V& out) const { out = k * u; }
  void damping_times(const V& u, V& out) const { out = d * u; }
  SolveReport solve_shifted(const Shift& shift, const V& rhs, V& out) const {
    out = rhs / (shift.mass + shift.damping * d + shift.stiffness * k);
    return {};
  }
  /// By Cramer's rule: all that is divided by is the one determinant.
  SolveReport solve_coupled(const StageCoupling& c, const std::vector<V>& rhs, std::vector<V>& out) const {
    const std::size_t s = rhs.size();
    std::vector<V> m(s * s);
    for (std::size_t i = 0; i < s; ++i)
      for (std::size_t j = 0; j < s; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        m[i * s + j] = c.damping(row, column) * d + c.stiffness(row, column) * k;
        if (i == j) m[i * s + j] = 1.0 + m[i * s + j];
      }
    const V all = determinant(m, s, 0, 0);
    for (std::size_t j = 0; j < s; ++j) {
      std::vector<V> replaced = m;
      for (std::size_t i = 0; i < s; ++i) replaced[i * s + j] = rhs[i];
      out[j] = determinant(replaced, s, 0, 0) / all;
    }
    return {};
  }
  SolveReport solve_damping(DampingPart, double h, const V& rhs, V& out) const {
    return solve_shifted({1, h, 0}, rhs, out);
  }
  void linearize(const V&, const V&, Linearization<V>& linear) const { linear = this; }

 private:
  // Of the rows from `row` on without the columns in the set `taken`.
  static V determinant(const std::vector<V>& m, std::size_t s, std::size_t row, unsigned taken) {
    V sum{};
    bool first = true, odd = false;
    for (std::size_t j = 0; j < s; ++j) {
      if (taken >> j & 1) continue;
      V term = m[row * s + j];
      if (row + 1 < s) term = term * determinant(m, s, row + 1, taken | 1U << j);
      if (odd) term = -term;
      if (first) {
        sum = term;
      } else {
        sum = sum + term;
      }
      first = false;
      odd = !odd;
    }
    return sum;
  }
};

}  // namespace springstab
