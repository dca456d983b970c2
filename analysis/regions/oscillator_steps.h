// A method on oscillators x'' = -Yx - Xv with h = 1, from the template that is the method: its matrix A(X, Y)
// over any vector type, and radii and simulations for eight oscillators at a time. Used by analysis/method.h;
// not for others.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "solvers/oscillator.h"
#include "solvers/stepper.h"

namespace springstab {

/// Outcome of simulating one oscillator from (x, v) = (1, 0.7).
enum class CellFate : char { decayed, bounded, diverged };

inline constexpr Eigen::Index lanes = 8;
using Lanes = Eigen::Array<double, lanes, 1>;

/// A, m x m, row by row into `a`: the steps from the unit states. False where a step is not finite: at a pole
/// (1 + X + Y = 0 for implicit Euler) of any of the oscillators.
template <class V, class Steps>
inline bool step_unit_states(Steps& steps, const Oscillator<V>& oscillator, const V& one, const V& zero,
                             std::size_t m, std::span<V> a) {
  State<V> state{zero, zero, std::vector<V>(m - 2, zero)};
  for (std::size_t j = 0; j < m; ++j) {
    state.x = j == 0 ? one : zero;
    state.v = j == 1 ? one : zero;
    for (std::size_t i = 2; i < m; ++i) state.memory[i - 2] = i == j ? one : zero;
    if (steps.step(oscillator, 1.0, state) != StepStatus::done) return false;
    a[j] = state.x;
    a[m + j] = state.v;
    for (std::size_t i = 2; i < m; ++i) a[i * m + j] = state.memory[i - 2];
  }
  return true;
}

template <class V, class Description>
std::optional<std::vector<V>> oscillator_matrix(const Description& description,
                                                const Oscillator<V>& oscillator, const V& one,
                                                const V& zero) {
  auto steps = make_steps<V>(description);
  const auto m = static_cast<std::size_t>(2 + description.info().memory);
  std::vector<V> a(m * m);
  if (!step_unit_states<V>(steps, oscillator, one, zero, m, a)) return std::nullopt;
  return a;
}

template <class Description>
Eigen::MatrixXd amplification_at(const Description& description, double x, double y) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index m = 2 + description.info().memory;
  const auto a = oscillator_matrix<double>(description, {.k = y, .d = x}, 1.0, 0.0);
  if (!a) return Eigen::MatrixXd::Constant(m, m, std::numeric_limits<double>::infinity());
  return Eigen::Map<const RowMajor>(a->data(), m, m);
}

/// What a run starts from, m x 2: x and v, and what is carried, of the starts x = 1 and v = 1.
template <class Description>
Eigen::MatrixXd starts_at(const Description& description, double x, double y) {
  const Oscillator<double> oscillator{.k = y, .d = x};
  auto steps = make_steps<double>(description);
  Eigen::MatrixXd starts(2 + description.info().memory, 2);
  for (Eigen::Index j = 0; j < 2; ++j) {
    State<double> state{j == 0 ? 1.0 : 0.0, j == 1 ? 1.0 : 0.0};
    start_steps(steps, description.info().memory, oscillator, 1.0, state);
    starts(0, j) = state.x;
    starts(1, j) = state.v;
    for (std::size_t i = 0; i < state.memory.size(); ++i)
      starts(2 + static_cast<Eigen::Index>(i), j) = state.memory[i];
  }
  return starts;
}

/// The largest |λ|; ∞ where an entry is not finite.
double matrix_radius(const Eigen::MatrixXd& a);

/// ρ of eight m x m matrices, by squaring: ρ^n = ‖Aⁿ‖ but for a factor whose n-th root is within 1e-10 of 1
/// at n = 2^40, and within 1e-9 where an eigenvalue that has too few vectors is the largest.
template <std::size_t m>
Lanes power_radii(std::array<Lanes, m * m>& a) {
  constexpr int squarings = 40, between_logarithms = 4;  // ρ/‖A‖ of 1e-19 does not underflow in four
  Lanes log_radius = Lanes::Zero();
  std::array<Lanes, m * m> square;
  for (int k = 0; k < squarings; ++k) {
    if (k % between_logarithms == 0) {
      Lanes size = a[0].abs();
      for (std::size_t i = 1; i < m * m; ++i) size = size.max(a[i].abs());
      size = (size > 0).select(size, 1.0);
      const Lanes scale = 1 / size;
      for (Lanes& entry : a) entry *= scale;
      log_radius += size.log() * std::ldexp(1.0, -k);
    }
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j) {
        Lanes sum = a[i * m] * a[j];
        for (std::size_t l = 1; l < m; ++l) sum += a[i * m + l] * a[l * m + j];
        square[i * m + j] = sum;
      }
    a.swap(square);
  }
  Lanes size = a[0].abs();
  for (std::size_t i = 1; i < m * m; ++i) size = size.max(a[i].abs());
  return (size > 0).select((log_radius + size.log() * std::ldexp(1.0, -squarings)).exp(), 0.0);
}

/// ρ of eight 3x3 matrices: by Newton's method the one real eigenvalue that is farthest from the inflection
/// of the characteristic polynomial, from outside it but for one step, and the other two in closed form.
inline Lanes cubic_radii(const std::array<Lanes, 9>& a) {
  const Lanes e1 = a[0] + a[4] + a[8];
  const Lanes minor = a[4] * a[8] - a[5] * a[7];
  const Lanes e2 = (a[0] * a[4] - a[1] * a[3]) + (a[0] * a[8] - a[2] * a[6]) + minor;
  const Lanes e3 = a[0] * minor - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
  const Lanes inflection = e1 / 3;  // λ = inflection + t: t³ + pt + q
  const Lanes p = e2 - e1 * inflection;
  const Lanes q = inflection * (e2 - 2.0 / 3 * e1 * inflection) - e3;
  const Lanes cube_root = ((q.abs() + std::numeric_limits<double>::min()).log() / 3).exp();
  Lanes t = cube_root.max(2 * (p.min(0.0) / -3).sqrt());
  t = (q > 0).select(-t, t);
  for (int i = 0; i < 9; ++i) {
    const Lanes slope = 3 * t * t + p;
    t -= (slope > 0).select(((t * t + p) * t + q) / slope, 0.0);
  }
  const Lanes lambda = inflection + t, half = 0.5 * (e1 - lambda);
  const Lanes product = e2 - lambda * (e1 - lambda), s = half * half - product;
  return lambda.abs().max((s >= 0).select(half.abs() + s.abs().sqrt(), product.abs().sqrt()));
}

/// ρ(A) of a method that carries m - 2 numbers, m = 3 or 4.
template <std::size_t m, class Description>
std::optional<Lanes> lane_radii_with_memory(const Description& description, const Lanes& x, const Lanes& y) {
  auto steps = make_steps<Lanes>(description);
  std::array<Lanes, m * m> a;
  if (!step_unit_states<Lanes>(steps, {.k = y, .d = x}, Lanes::Ones(), Lanes::Zero(), m, a))
    return std::nullopt;
  if constexpr (m == 3) {
    return cubic_radii(a);
  } else {
    return power_radii<m>(a);
  }
}

/// ρ(A) of a method that carries nothing.
/// λ = m ± √s with m = (a11 + a22)/2, s = ((a11 - a22)/2)² + a12 a21: no cancellation where s is small.
template <class Description>
std::optional<Lanes> lane_radii(const Description& description, const Lanes& x, const Lanes& y) {
  auto steps = make_steps<Lanes>(description);
  std::array<Lanes, 4> a;
  if (!step_unit_states<Lanes>(steps, {.k = y, .d = x}, Lanes::Ones(), Lanes::Zero(), 2, a))
    return std::nullopt;
  const auto& [a11, a12, a21, a22] = a;
  const Lanes m = 0.5 * (a11 + a22);
  const Lanes half = 0.5 * (a11 - a22);
  const Lanes s = half * half + a12 * a21;
  return (s >= 0).select(m.abs() + s.abs().sqrt(), (m * m - s).abs().sqrt());
}

/// Calls body(x, y, first, count) for groups of eight cells; the last group is filled up with its last cell.
template <class Body>
void for_each_group(std::span<const double> x, std::span<const double> y, Body body) {
  const auto n = static_cast<Eigen::Index>(x.size());
  for (Eigen::Index first = 0; first < n; first += lanes) {
    const Eigen::Index count = std::min(lanes, n - first);
    Lanes xs = Lanes::Constant(x[static_cast<std::size_t>(first + count - 1)]);
    Lanes ys = Lanes::Constant(y[static_cast<std::size_t>(first + count - 1)]);
    xs.head(count) = Eigen::Map<const Eigen::ArrayXd>(x.data() + first, count);
    ys.head(count) = Eigen::Map<const Eigen::ArrayXd>(y.data() + first, count);
    body(xs, ys, first, count);
  }
}

/// By radii(xs, ys) of eight cells together, one by one where that gives nothing.
template <class Radii>
void radii_by_lanes(std::span<const double> x, std::span<const double> y, std::span<double> rho,
                    const Radii& radii) {
  for_each_group(x, y, [&](const Lanes& xs, const Lanes& ys, Eigen::Index first, Eigen::Index count) {
    Eigen::Map<Eigen::ArrayXd> out(rho.data() + first, count);
    if (const auto together = radii(xs, ys)) {
      out = together->head(count);
    } else {
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto alone = radii(Lanes::Constant(xs[i]), Lanes::Constant(ys[i]));
        out[i] = alone ? (*alone)[0] : std::numeric_limits<double>::infinity();
      }
    }
  });
}

template <class Description>
void radii_of(const Description& description, std::span<const double> x, std::span<const double> y,
              std::span<double> rho) {
  switch (description.info().memory) {
    case 0:
      return radii_by_lanes(
          x, y, rho, [&](const Lanes& xs, const Lanes& ys) { return lane_radii(description, xs, ys); });
    case 1:
      return radii_by_lanes(x, y, rho, [&](const Lanes& xs, const Lanes& ys) {
        return lane_radii_with_memory<3>(description, xs, ys);
      });
    case 2:
      return radii_by_lanes(x, y, rho, [&](const Lanes& xs, const Lanes& ys) {
        return lane_radii_with_memory<4>(description, xs, ys);
      });
    default:
      for (std::size_t i = 0; i < x.size(); ++i)
        rho[i] = matrix_radius(amplification_at(description, x[i], y[i]));
  }
}

using LaneFates = Eigen::Array<CellFate, lanes, 1>;

/// Eight simulations side by side; nothing when a single step overflowed in one of them.
template <class Description>
std::optional<LaneFates> simulate_group(const Description& description, const Lanes& x, const Lanes& y,
                                        long steps, double threshold) {
  const Oscillator<Lanes> oscillator{.k = y, .d = x};
  auto method = make_steps<Lanes>(description);
  State<Lanes> state{Lanes::Ones(), Lanes::Constant(0.7)};
  start_steps(method, description.info().memory, oscillator, 1.0, state);
  Eigen::Array<bool, lanes, 1> diverged = Eigen::Array<bool, lanes, 1>::Constant(false);
  for (long i = 0; i < steps && !diverged.all(); ++i) {
    if (method.step(oscillator, 1.0, state) != StepStatus::done) return std::nullopt;
    diverged = diverged || state.x.abs().max(state.v.abs()) > threshold;
    state.x = diverged.select(0.0, state.x);  // at rest from here on, lest it overflow
    state.v = diverged.select(0.0, state.v);
    for (Lanes& u : state.memory) u = diverged.select(0.0, u);
  }
  const Lanes size = state.x.abs().max(state.v.abs());
  LaneFates fates;
  for (Eigen::Index i = 0; i < lanes; ++i)
    fates[i] = diverged[i]               ? CellFate::diverged
               : size[i] < 1 / threshold ? CellFate::decayed
                                         : CellFate::bounded;
  return fates;
}

template <class Description>
void fates_of(const Description& description, std::span<const double> x, std::span<const double> y,
              long steps, double threshold, std::span<CellFate> fate) {
  const auto simulate = [&](const Lanes& xs, const Lanes& ys) {
    return simulate_group(description, xs, ys, steps, threshold);
  };
  for_each_group(x, y, [&](const Lanes& xs, const Lanes& ys, Eigen::Index first, Eigen::Index count) {
    const std::optional<LaneFates> together = simulate(xs, ys);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto alone = together ? std::nullopt : simulate(Lanes::Constant(xs[i]), Lanes::Constant(ys[i]));
      fate[static_cast<std::size_t>(first + i)] = together ? (*together)[i]
                                                  : alone  ? (*alone)[i]
                                                           : CellFate::diverged;
    }
  });
}

}  // namespace springstab
