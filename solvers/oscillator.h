// One oscillator x'' = -k x - d v, or several side by side: the scalar mode on which a method's
// stability is decided. Everything is elementwise, so V may be a double, an array of oscillators,
// or a symbol that records the formula.
#pragma once

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
  SolveReport solve_damping(DampingPart, double h, const V& rhs, V& out) const {
    return solve_shifted({1, h, 0}, rhs, out);
  }
  void linearize(const V&, const V&, Linearization<V>& linear) const { linear = this; }
};

}  // namespace springstab
