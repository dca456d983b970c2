#include "analysis/spectra/chebyshev_filter.h"

#include <cmath>

namespace springstab {
namespace {

constexpr int degree = 16;
constexpr double below = 0.01;  // the top of the spectrum, as part of it, where the polynomial exceeds 1
constexpr double rough = 1e-2;  // tolerance of that value
constexpr Eigen::Index rough_basis = 10, basis = 20;

// T_degree of A mapped so that [lowest, cut] becomes [-1, 1].
class ChebyshevFilter {
 public:
  ChebyshevFilter(const LinearOperator& a, double cut)
      : a_(a), centre_((cut + a.lowest) / 2), half_((cut - a.lowest) / 2) {}

  void operator()(const Eigen::VectorXd& in, Eigen::VectorXd& out) {
    before_ = in;
    a_.apply(in, image_);
    out = (image_ - centre_ * in) / half_;
    for (int i = 1; i < degree; ++i) {  // T_{i+1}(x) = 2x T_i(x) - T_{i-1}(x)
      a_.apply(out, image_);
      before_ = (image_ - centre_ * out) * (2 / half_) - before_;
      before_.swap(out);
    }
  }

 private:
  const LinearOperator& a_;
  double centre_, half_;
  Eigen::VectorXd before_, image_;
};

}  // namespace

SymmetricEigenpairs largest_eigenpair(const LinearOperator& a, const ArpackOptions& options) {
  if (!std::isfinite(a.lowest)) return largest_eigenpairs(a, 1, options);
  ArpackOptions first = options;
  first.tolerance = std::max(options.tolerance, rough);
  first.basis_size = rough_basis;
  SymmetricEigenpairs found = largest_eigenpairs(a, 1, first);
  if (found.converged && first.tolerance == options.tolerance) return found;
  const double largest = found.converged ? found.values[0] : 0;
  if (!(largest > 0 && largest >= -a.lowest)) return largest_eigenpairs(a, 1, options);

  ChebyshevFilter filter(a, largest - below * (largest - a.lowest));
  ArpackOptions second = options;
  second.basis_size = basis;
  second.start = found.vectors.col(0) + rough * start_vector(a.size, {}, options.seed).normalized();
  SymmetricEigenpairs filtered = largest_eigenpairs({a.size, std::ref(filter)}, 1, second);
  filtered.products = found.products + degree * filtered.products;
  if (!filtered.converged) return filtered;
  Eigen::VectorXd image;
  a.apply(filtered.vectors.col(0), image);
  ++filtered.products;
  filtered.values[0] = filtered.vectors.col(0).dot(image);
  image -= filtered.values[0] * filtered.vectors.col(0);
  filtered.residuals[0] = image.stableNorm();
  return filtered;
}

}  // namespace springstab
