#include "analysis/spectra/undamped_motions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "analysis/constants.h"

namespace springstab {
namespace {

constexpr double resolved = 1e3;  // roundings in the shape of an eigenvector

// Where an eigenvalue is multiple, the eigenvectors that D' does not see come last.
Eigen::MatrixXd parted(const Eigen::MatrixXd& x, const Eigen::MatrixXd& damping) {
  if (x.cols() == 1) return x;
  const Eigen::MatrixXd seen = (damping * x).transpose();
  return x * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(seen).householderQ();
}

}  // namespace

UndampedMotions undamped_motions(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& damping) {
  const Eigen::Index n = stiffness.rows();
  const double round_off = 4 * unit_roundoff * static_cast<double>(n);
  const double equal = round_off * stiffness.norm();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const Eigen::MatrixXd sizes = damping.cwiseAbs();
  Eigen::MatrixXd found(n, n);
  Eigen::Index count = 0;
  for (Eigen::Index first = 0, last = 0; first < n; first = last) {
    while (++last < n && values[last] - values[last - 1] <= equal) continue;
    const Eigen::MatrixXd shapes = parted(solver.eigenvectors().middleCols(first, last - first), damping);
    for (Eigen::Index j = 0; j < shapes.cols(); ++j) {
      const Eigen::VectorXd x = shapes.col(j);
      if ((damping * x).norm() <= resolved * round_off * (sizes * x.cwiseAbs()).norm())
        found.col(count++) = x;
    }
  }
  const auto kept = found.leftCols(count);
  const Eigen::VectorXd lambda = (kept.transpose() * stiffness * kept).diagonal();
  const Eigen::MatrixXd all = Eigen::HouseholderQR<Eigen::MatrixXd>(kept).householderQ();
  return {lambda, all.rightCols(n - count)};
}

}  // namespace springstab
