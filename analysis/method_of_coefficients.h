// Methods whose coefficients are known at run time only, as those from files.
//
//     const Method kutta3 = method_of({"kutta3", "Kutta 3"}, runge_kutta(a, b));
//     add_method(kutta3);                       // from here on Method("kutta3") is this one
#pragma once

#include <string>

#include "analysis/method.h"
#include "solvers/methods/multistep.h"
#include "solvers/methods/tableau.h"

namespace springstab {

struct MethodName {
  std::string name, title;
};

Method method_of(const MethodName& name, const StageTableau& tableau);
Method method_of(const MethodName& name, const Multistep& formula);

}  // namespace springstab
