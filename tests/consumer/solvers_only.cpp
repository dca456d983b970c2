// Uses the installed solvers alone, where neither GSL nor ARPACK need be.
#include <iostream>

#include "oscillators.h"
#include "solvers/methods/rk4.h"

int main() {
  const double error = error_after_a_period(springstab::make_stepper(springstab::Rk4()));
  std::cout << "error after one period " << error << '\n';
  return error < 1e-6 ? 0 : 1;
}
