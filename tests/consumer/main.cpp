// Uses both installed libraries from outside: prints the phase error of a method and its step as a matrix.
#include <iostream>

#include "analysis/method.h"
#include "oscillators.h"

int main() {
  const double error = error_after_a_period(springstab::Method("rk4").stepper());
  std::cout << "error after one period " << error << ", one step's matrix\n"
            << springstab::Method("rk4").amplification(0.0, 1.0) << '\n';
  return error < 1e-6 ? 0 : 1;
}
