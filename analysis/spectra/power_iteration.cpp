#include "analysis/spectra/power_iteration.h"

#include <cmath>
#include <stdexcept>

namespace springstab {

PowerIteration power_iteration(const LinearOperator& a, const PowerIterationOptions& options) {
  PowerIteration found;
  found.vector = start_vector(a.size, options.start, options.seed);
  found.vector /= found.vector.norm();
  Eigen::VectorXd image;
  while (found.products < options.max_products) {
    a.apply(found.vector, image);
    ++found.products;
    const double length = image.norm();
    if (!std::isfinite(length))
      throw std::invalid_argument("the operator's product is not finite, expected finite matrices");
    found.value = found.vector.dot(image);
    found.residual = (image - found.value * found.vector).norm();
    found.converged = found.residual <= options.tolerance * std::abs(found.value);
    if (found.converged || length == 0) break;
    found.vector = image / length;
  }
  return found;
}

}  // namespace springstab
