// Enumerators as words, from one table each.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace springstab {

/// The name that stands beside `value` in the table. Throws std::logic_error if none does.
template <class Enum, std::size_t count>
const char* name_in(const std::pair<Enum, const char*> (&table)[count], Enum value) {
  for (const auto& [known, name] : table)
    if (known == value) return name;
  throw std::logic_error("enumerator " + std::to_string(static_cast<int>(value)) + " has no name");
}

}  // namespace springstab
