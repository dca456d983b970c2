// Uses both installed libraries from outside: prints the phase error of a method and its step as a matrix.
#include <iostream>

#include "analysis/regions/amplification.h"
#include "oscillators.h"

int main() {
  const double error = error_after_a_period("rk4");
  std::cout << "error after one period " << error << ", one step's matrix\n"
            << springstab::amplification_matrix("rk4", 0.0, 1.0) << '\n';
  return error < 1e-6 ? 0 : 1;
}
