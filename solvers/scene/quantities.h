// What the readers of cloths, nets and solids ask of a number, and how their messages show it.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

namespace springstab {

inline std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

inline bool positive(double value) { return value > 0 && std::isfinite(value); }

}  // namespace springstab
