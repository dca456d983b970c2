// A method from a JSON file: a Runge-Kutta, partitioned or Nyström tableau of any kind, or a linear multistep
// method of the first- or second-order form.
//
//     {"name": "kutta3", "kind": "runge-kutta", "A": [[], ["1/2"], [-1, 2]], "b": ["1/6", "2/3", "1/6"]}
//
// Coefficients are numbers, or fractions in quotes. Keys of each kind (docs/methods.md, "Methods from
// files"):
//     runge-kutta   A, b, and c, which is then checked
//     partitioned   position: {A, b}, velocity: {A, b}
//     nystrom       c, position: {A, b}, velocity: {A, b}: the factors of h² and h
//     (solvers/methods/tableau.h) multistep     form: first-order or second-order, alpha, beta from the
//     oldest state to the new one, and
//                   in the second-order form velocity: {x, a} (solvers/methods/multistep.h)
#pragma once

#include <string>
#include <string_view>

#include "analysis/method.h"

namespace springstab {

/// Throws InputError(source, line, ...) for what is no method or an inconsistent one.
Method parse_method(const std::string& source, std::string_view text);
Method read_method_file(const std::string& path);

}  // namespace springstab
