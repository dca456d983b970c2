#include "analysis/method.h"

#include <map>
#include <mutex>
#include <stdexcept>

#include "solvers/methods/list.h"
#include "solvers/methods/parameters.h"

namespace springstab {
namespace {

template <class Description>
Method made_from(Parameters& given) {
  const auto description = [&] {
    if constexpr (std::is_constructible_v<Description, Parameters&>) {
      return Description(given);
    } else {
      return Description();
    }
  }();
  given.check_all_asked_for();
  return make_method(description);
}

template <class List>
std::optional<Method> find(Parameters& given) {
  std::optional<Method> found;
  List::for_each([&]<class Description>(const Description& description) {
    if (description.info().name == given.name()) found = made_from<Description>(given);
  });
  return found;
}

template <class List>
std::vector<Method> made_of_list() {
  std::vector<Method> methods;
  List::for_each([&](const auto& description) { methods.push_back(make_method(description)); });
  return methods;
}

std::vector<Method>& added() {
  static std::vector<Method> methods;
  return methods;
}

Method made(std::string_view text) {
  std::string known;
  for (const auto* list : {&all_methods(), &more_methods(), &added_methods()})
    for (const Method& method : *list) {
      if (method.name() == text) return method;
      known += (known.empty() ? "" : ", ") + method.name();
    }
  Parameters given(text);
  if (const auto method = find<Methods>(given)) return *method;
  if (const auto method = find<MoreMethods>(given)) return *method;
  throw UnknownMethod(given.name(), "unknown method '" + given.name() + "', expected one of " + known);
}

const Method& built_in(std::string_view text) {
  static std::mutex mutex;
  static std::map<std::string, Method, std::less<>> all;
  const std::lock_guard lock(mutex);
  if (const auto known = all.find(text); known != all.end()) return known->second;
  return all.emplace(text, made(text)).first->second;
}

}  // namespace

const std::vector<Method>& all_methods() {
  static const std::vector<Method> all = made_of_list<Methods>();
  return all;
}

const std::vector<Method>& more_methods() {
  static const std::vector<Method> all = made_of_list<MoreMethods>();
  return all;
}

std::vector<Method> built_in_methods() {
  std::vector<Method> all = all_methods();
  all.insert(all.end(), more_methods().begin(), more_methods().end());
  return all;
}

void add_method(const Method& method) {
  for (const auto* list : {&all_methods(), &more_methods(), &added_methods()})
    for (const Method& known : *list)
      if (known.name() == method.name())
        throw std::invalid_argument("the name '" + method.name() +
                                    "' is another method's, expected a new one");
  added().push_back(method);
}

const std::vector<Method>& added_methods() { return added(); }

Method::Method(std::string_view name) : Method(built_in(name)) {}

}  // namespace springstab
