#include "analysis/regions/amplification.h"

#include <Eigen/Eigenvalues>
#include <limits>
#include <stdexcept>

namespace springstab {

double matrix_radius(const Eigen::MatrixXd& a) {
  if (!a.allFinite()) return std::numeric_limits<double>::infinity();
  return a.eigenvalues().cwiseAbs().maxCoeff();
}

void spectral_radius(const Method& method, std::span<const double> x, std::span<const double> y,
                     std::span<double> rho) {
  if (x.size() != y.size() || x.size() != rho.size())
    throw std::invalid_argument("spectral_radius: x, y and rho must have one length");
  method.radii(x, y, rho);
}

void simulate_cells(const Method& method, std::span<const double> x, std::span<const double> y, long steps,
                    double threshold, std::span<CellFate> fate) {
  if (x.size() != y.size() || x.size() != fate.size())
    throw std::invalid_argument("simulate_cells: x, y and fate must have one length");
  method.fates(x, y, steps, threshold, fate);
}

}  // namespace springstab
