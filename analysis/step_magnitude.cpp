#include "analysis/step_magnitude.h"

#include <cmath>

#include "solvers/methods/list.h"
#include "solvers/stepper.h"

namespace springstab {
namespace {

/// Sizes of the unknowns from each of the 2n unit starts, in columns.
struct Magnitude {
  Eigen::MatrixXd entries;

  bool allFinite() const { return entries.allFinite(); }
  friend Magnitude operator+(const Magnitude& a, const Magnitude& b) { return {a.entries + b.entries}; }
  [[maybe_unused]] friend Magnitude operator-(const Magnitude& a, const Magnitude& b) { return a + b; }
  friend Magnitude operator*(double factor, const Magnitude& a) { return {std::abs(factor) * a.entries}; }
};

struct MagnitudeSystem {
  Eigen::MatrixXd stiffness, damping;

  void acceleration(const Magnitude& x, const Magnitude& v, Magnitude& a) const {
    a.entries = stiffness * x.entries + damping * v.entries;
  }
};

template <class Method>
std::optional<Eigen::MatrixXd> magnitude(MagnitudeSystem& system) {
  const Eigen::Index n = system.stiffness.rows();
  State<Magnitude> state{{Eigen::MatrixXd::Identity(n, 2 * n)}, {Eigen::MatrixXd::Zero(n, 2 * n)}};
  state.v.entries.rightCols(n).setIdentity();
  if constexpr (requires(Method method) { method.step(system, 1.0, state); }) {
    Method method;
    if (method.step(system, 1.0, state) != StepStatus::done) return std::nullopt;
    Eigen::MatrixXd result(2 * n, 2 * n);
    result << state.x.entries, state.v.entries;
    return result;
  } else {
    return std::nullopt;
  }
}

}  // namespace

std::optional<Eigen::MatrixXd> step_magnitude(std::string_view method, const Eigen::MatrixXd& stiffness,
                                              const Eigen::MatrixXd& damping) {
  MagnitudeSystem system{stiffness.cwiseAbs(), damping.cwiseAbs()};
  const std::string_view name = find_method(method).name;
  std::optional<Eigen::MatrixXd> result;
  Methods::for_each([&]<template <class> class Method>() {
    if (Method<Magnitude>::info.name == name) result = magnitude<Method<Magnitude>>(system);
  });
  return result;
}

}  // namespace springstab
