#include "analysis/proofs/step_magnitude.h"

#include "solvers/methods/list.h"
#include "solvers/stepper.h"

namespace springstab {

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
