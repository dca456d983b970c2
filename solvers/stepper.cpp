#include "solvers/stepper.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/methods/list.h"

namespace springstab {
namespace {

template <class Method>
concept KeepsLinearization = requires(Method& method) {
  method.restart(1L);
};

template <template <class> class Method>
class StepperOf final : public Stepper {
 public:
  void restart(long steps_per_linearization) override {
    if constexpr (KeepsLinearization<Method<Vector>>) method_.restart(steps_per_linearization);
  }
  StepStatus step(System& system, double h, State<Vector>& state) override {
    return method_.step(system, h, state);
  }

 private:
  Method<Vector> method_;
};

struct Registry {
  std::vector<MethodInfo> infos;
  std::vector<std::unique_ptr<Stepper> (*)()> makers;

  Registry() {
    Methods::for_each([this]<template <class> class Method>() {
      infos.push_back(Method<Vector>::info);
      makers.push_back([]() -> std::unique_ptr<Stepper> { return std::make_unique<StepperOf<Method>>(); });
    });
  }

  std::size_t index(std::string_view name) const {
    std::string known;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (infos[i].name == name) return i;
      known += (i ? ", " : "") + std::string(infos[i].name);
    }
    throw std::invalid_argument("unknown method '" + std::string(name) + "', expected one of " + known);
  }
};

const Registry& registry() {
  static const Registry instance;
  return instance;
}

}  // namespace

std::span<const MethodInfo> all_methods() { return registry().infos; }

const MethodInfo& find_method(std::string_view name) { return registry().infos[registry().index(name)]; }

std::unique_ptr<Stepper> make_stepper(std::string_view name) {
  return registry().makers[registry().index(name)]();
}

}  // namespace springstab
