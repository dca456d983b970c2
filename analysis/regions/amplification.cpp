#include "analysis/regions/amplification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "solvers/methods/list.h"
#include "solvers/oscillator.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

constexpr Eigen::Index lanes = 8;
using Lanes = Eigen::Array<double, lanes, 1>;

// A, row by row, from any vector type; nothing where a step is not finite: at a pole (1 + X + Y = 0 for
// implicit Euler) of any of the oscillators.
template <template <class> class Method, class V>
std::optional<std::array<V, 4>> amplification(const Oscillator<V>& oscillator, const V& one, const V& zero) {
  Method<V> method;
  State<V> from_x{one, zero}, from_v{zero, one};
  if (method.step(oscillator, 1.0, from_x) != StepStatus::done) return std::nullopt;
  if (method.step(oscillator, 1.0, from_v) != StepStatus::done) return std::nullopt;
  return std::array<V, 4>{from_x.x, from_v.x, from_x.v, from_v.v};
}

template <template <class> class Method>
SymbolicAmplification symbolic() {
  using F = RationalFunction;
  return *amplification<Method, F>({.k = BivariatePolynomial::y(), .d = BivariatePolynomial::x()}, 1.0, 0.0);
}

// λ = m ± √s with m = (a11 + a22)/2, s = ((a11 - a22)/2)² + a12 a21: no cancellation where s is small.
template <template <class> class Method>
std::optional<Lanes> radii(const Lanes& x, const Lanes& y) {
  const auto a = amplification<Method, Lanes>({.k = y, .d = x}, Lanes::Ones(), Lanes::Zero());
  if (!a) return std::nullopt;
  const auto& [a11, a12, a21, a22] = *a;
  const Lanes m = 0.5 * (a11 + a22);
  const Lanes half = 0.5 * (a11 - a22);
  const Lanes s = half * half + a12 * a21;
  return (s >= 0).select(m.abs() + s.abs().sqrt(), (m * m - s).abs().sqrt());
}

// Calls body(x, y, first, count) for groups of eight cells; the last group is filled up with its last cell.
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

template <template <class> class Method>
void radii_of(std::span<const double> x, std::span<const double> y, std::span<double> rho) {
  for_each_group(x, y, [&](const Lanes& xs, const Lanes& ys, Eigen::Index first, Eigen::Index count) {
    Eigen::Map<Eigen::ArrayXd> out(rho.data() + first, count);
    if (const auto together = radii<Method>(xs, ys)) {
      out = together->head(count);
    } else {
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto alone = radii<Method>(Lanes::Constant(xs[i]), Lanes::Constant(ys[i]));
        out[i] = alone ? (*alone)[0] : std::numeric_limits<double>::infinity();
      }
    }
  });
}

using LaneFates = Eigen::Array<CellFate, lanes, 1>;

// Eight simulations side by side; nothing when a single step overflowed in one of them.
template <template <class> class Method>
std::optional<LaneFates> simulate_group(const Lanes& x, const Lanes& y, long steps, double threshold) {
  const Oscillator<Lanes> oscillator{.k = y, .d = x};
  Method<Lanes> method;
  State<Lanes> state{Lanes::Ones(), Lanes::Constant(0.7)};
  Eigen::Array<bool, lanes, 1> diverged = Eigen::Array<bool, lanes, 1>::Constant(false);
  for (long i = 0; i < steps && !diverged.all(); ++i) {
    if (method.step(oscillator, 1.0, state) != StepStatus::done) return std::nullopt;
    diverged = diverged || state.x.abs().max(state.v.abs()) > threshold;
    state.x = diverged.select(0.0, state.x);  // at rest from here on, lest it overflow
    state.v = diverged.select(0.0, state.v);
  }
  const Lanes size = state.x.abs().max(state.v.abs());
  LaneFates fates;
  for (Eigen::Index i = 0; i < lanes; ++i)
    fates[i] = diverged[i]               ? CellFate::diverged
               : size[i] < 1 / threshold ? CellFate::decayed
                                         : CellFate::bounded;
  return fates;
}

template <template <class> class Method>
void fates_of(std::span<const double> x, std::span<const double> y, long steps, double threshold,
              std::span<CellFate> fate) {
  for_each_group(x, y, [&](const Lanes& xs, const Lanes& ys, Eigen::Index first, Eigen::Index count) {
    const std::optional<LaneFates> together = simulate_group<Method>(xs, ys, steps, threshold);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto alone =
          together ? std::nullopt
                   : simulate_group<Method>(Lanes::Constant(xs[i]), Lanes::Constant(ys[i]), steps, threshold);
      fate[static_cast<std::size_t>(first + i)] = together ? (*together)[i]
                                                  : alone  ? (*alone)[i]
                                                           : CellFate::diverged;
    }
  });
}

template <template <class> class Method>
Eigen::Matrix2d matrix(double x, double y) {
  const auto a = amplification<Method, double>({.k = y, .d = x}, 1.0, 0.0);
  if (!a) return Eigen::Matrix2d::Constant(std::numeric_limits<double>::infinity());
  return Eigen::Matrix2d{{(*a)[0], (*a)[1]}, {(*a)[2], (*a)[3]}};
}

struct Functions {
  std::string_view name;
  Eigen::Matrix2d (*matrix)(double, double);
  SymbolicAmplification (*symbolic)();
  void (*radii)(std::span<const double>, std::span<const double>, std::span<double>);
  void (*fates)(std::span<const double>, std::span<const double>, long, double, std::span<CellFate>);
};

const Functions& functions(std::string_view method) {
  static const std::vector<Functions> table = [] {
    std::vector<Functions> all;
    Methods::for_each([&]<template <class> class Method>() {
      all.push_back(
          {Method<double>::info.name, matrix<Method>, symbolic<Method>, radii_of<Method>, fates_of<Method>});
    });
    return all;
  }();
  const std::string_view name = find_method(method).name;
  return *std::find_if(table.begin(), table.end(), [&](const Functions& f) { return f.name == name; });
}

}  // namespace

SymbolicAmplification symbolic_amplification(std::string_view method) { return functions(method).symbolic(); }

Eigen::Matrix2d amplification_matrix(std::string_view method, double x, double y) {
  return functions(method).matrix(x, y);
}

void spectral_radius(std::string_view method, std::span<const double> x, std::span<const double> y,
                     std::span<double> rho) {
  if (x.size() != y.size() || x.size() != rho.size())
    throw std::invalid_argument("spectral_radius: x, y and rho must have one length");
  functions(method).radii(x, y, rho);
}

void simulate_cells(std::string_view method, std::span<const double> x, std::span<const double> y, long steps,
                    double threshold, std::span<CellFate> fate) {
  if (x.size() != y.size() || x.size() != fate.size())
    throw std::invalid_argument("simulate_cells: x, y and fate must have one length");
  functions(method).fates(x, y, steps, threshold, fate);
}

}  // namespace springstab
