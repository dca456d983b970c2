// Random vectors, and what is known of small dense matrices.
#pragma once

#include <cstdint>
#include <random>

#include "solvers/linear/dense_solvers.h"

namespace springstab::test {

/// Entries from -1 to 1.
inline Eigen::VectorXd random_vector(Eigen::Index size, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd v(size);
  for (double& entry : v) entry = uniform(engine);
  return v;
}

/// Of a symmetric matrix.
inline double smallest_eigenvalue(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues()[0];
}

}  // namespace springstab::test
