// Uses the installed solvers alone, where neither GSL nor ARPACK need be.
#include <iostream>

#include "oscillators.h"

int main() {
  const double error = error_after_a_period("rk4");
  std::cout << "error after one period " << error << '\n';
  return error < 1e-6 ? 0 : 1;
}
