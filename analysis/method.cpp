#include "analysis/method.h"

#include "solvers/methods/list.h"

namespace springstab {
namespace {

const Method& built_in(std::string_view name) {
  std::string known;
  for (const Method& method : all_methods()) {
    if (method.name() == name) return method;
    known += (known.empty() ? "" : ", ") + method.name();
  }
  const std::string given(name);
  throw UnknownMethod(given, "unknown method '" + given + "', expected one of " + known);
}

}  // namespace

const std::vector<Method>& all_methods() {
  static const std::vector<Method> all = [] {
    std::vector<Method> methods;
    Methods::for_each([&](const auto& description) { methods.push_back(make_method(description)); });
    return methods;
  }();
  return all;
}

Method::Method(std::string_view name) : Method(built_in(name)) {}

}  // namespace springstab
