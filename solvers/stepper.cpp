#include "solvers/stepper.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/methods/list.h"

namespace springstab {
namespace {

template <class Method>
concept KeepsLinearization = requires(Method& method) {
  method.forget();
};

template <template <class> class Method>
class StepperOf final : public Stepper {
 public:
  explicit StepperOf(long steps_per_linearization) {
    if constexpr (KeepsLinearization<Method<Vector>>)
      method_.set_steps_per_linearization(steps_per_linearization);
  }
  void forget() override {
    if constexpr (KeepsLinearization<Method<Vector>>) method_.forget();
  }
  StepStatus step(System& system, double h, State<Vector>& state) override {
    return method_.step(system, h, state);
  }

 private:
  Method<Vector> method_;
};

struct Registry {
  std::vector<MethodInfo> infos;
  std::vector<std::unique_ptr<Stepper> (*)(long)> makers;

  Registry() {
    Methods::for_each([this]<template <class> class Method>() {
      infos.push_back(Method<Vector>::info);
      makers.push_back([](long steps_per_linearization) -> std::unique_ptr<Stepper> {
        return std::make_unique<StepperOf<Method>>(steps_per_linearization);
      });
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

std::unique_ptr<Stepper> make_stepper(std::string_view name, long steps_per_linearization) {
  return registry().makers[registry().index(name)](steps_per_linearization);
}

}  // namespace springstab
