// What a method says of itself; everything else about it is computed from its step.
#pragma once

#include <string_view>

namespace springstab {

struct MethodInfo {
  std::string_view name;    // as typed on the command line
  std::string_view title;   // as printed in tables and figures
  int order;                // of accuracy in h
  bool implicit;            // whether a step solves a linear system
  bool linearized = false;  // an explicit method over forces frozen to a linear system (paper §4)
};

}  // namespace springstab
