// What this program was built with, of what it can do without.
#pragma once

#include <string>
#include <vector>

namespace springstab {

struct OptionalPart {
  const char* name;
  const char* purpose;
  bool built_in;
};

std::vector<OptionalPart> optional_parts();

/// "with A (for this), without B (for that)".
std::string optional_parts_text();

}  // namespace springstab
