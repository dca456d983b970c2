// Random nets of springs with dampers along them, whose D' and K' do not commute, and the dense truth about
// them, for tests.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "analysis/spectra/transition_operator.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"
#include "solvers/scene/spring_cloth.h"

namespace springstab::test {

/// Connected nets of 3 to 9 particles: masses over three decades, stiffness and damping over four, dampers
/// on all springs or on some. `stretched` springs are longer than at rest, others as long.
class RandomNets {
 public:
  explicit RandomNets(std::uint64_t seed) : engine_(seed) {}

  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  double log_uniform(double a, double b) { return std::pow(10, uniform(a, b)); }

  SpringNet net(bool stretched) {
    SpringNet net;
    const int n = static_cast<int>(uniform(3, 10));
    for (int i = 0; i < n; ++i) {
      net.rest.emplace_back(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      net.mass.push_back(log_uniform(-2, 1));
    }
    const double common_damping = log_uniform(-4, 0), damped = uniform(0, 1) < 0.5 ? 1 : 0.6;
    const auto join = [&](int i, int j) {
      const double length = (net.rest[i] - net.rest[j]).norm();
      net.springs.push_back({i, j, log_uniform(0, 4),
                             uniform(0, 1) < damped ? common_damping * log_uniform(0, 2) : 0,
                             stretched ? length * uniform(0.5, 1) : length});
    };
    for (int j = 1; j < n; ++j) join(static_cast<int>(uniform(0, j)), j);
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j)
        if (uniform(0, 1) < 0.4) join(i, j);
    return net;
  }

 private:
  std::mt19937_64 engine_;
};

/// K, M, D of the net where it is at rest, the first particle held.
inline StructuralMatrices matrices(const SpringNet& net, double d0 = 0) {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(net.rest.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n), d = k, m = k;
  for (const Spring& s : net.springs) {
    const Eigen::Vector3d u = net.rest[s.i] - net.rest[s.j];
    const double length = u.norm();
    const Eigen::Matrix3d axial = u * u.transpose() / (length * length);
    const Eigen::Matrix3d block = s.stiffness * (axial + std::max(0.0, 1 - s.rest_length / length) *
                                                             (Eigen::Matrix3d::Identity() - axial));
    for (const auto& [p, q, sign] :
         {std::tuple{s.i, s.i, 1.0}, {s.j, s.j, 1.0}, {s.i, s.j, -1.0}, {s.j, s.i, -1.0}}) {
      k.block<3, 3>(3 * p, 3 * q) += sign * block;
      d.block<3, 3>(3 * p, 3 * q) += sign * s.damping * axial;
    }
  }
  m = lumped_mass(net.mass);
  const Eigen::Index r = n - 3;
  d += d0 * m;
  const auto sparse = [&](const Eigen::MatrixXd& a) {
    return SparseMatrix(a.bottomRightCorner(r, r).sparseView(0.0, 0.0));
  };
  return prepare(sparse(k), sparse(m), sparse(d));
}

/// The same structure in another unit of time, t' = t/unit.
inline StructuralMatrices in_unit(const StructuralMatrices& s, double unit) {
  StructuralMatrices t = s;
  t.stiffness *= unit * unit;
  t.damping *= unit;
  return t;
}

inline double largest_modulus(const Eigen::MatrixXd& a) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(a, false).eigenvalues().cwiseAbs().maxCoeff();
}

/// The state transition matrix, one step of the method's own code per column.
inline Eigen::MatrixXd transition_matrix(const StructuralMatrices& s, std::string_view method, double h) {
  MatrixSystem system(s);
  const LinearOperator op = transition_operator(system, method, h);
  Eigen::MatrixXd a(op.size, op.size);
  Vector column;
  for (Eigen::Index j = 0; j < op.size; ++j) {
    op.apply(Vector::Unit(op.size, j), column);
    a.col(j) = column;
  }
  return a;
}

}  // namespace springstab::test
