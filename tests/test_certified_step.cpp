// The laws of stable steps under damping that does not commute with the stiffness: exact where a condition is
// exact for matrices, proved otherwise, and never above the truth of dense eigenvalues.
#include <Eigen/Eigenvalues>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>

#include "analysis/general_damping.h"
#include "solvers/scene/every_pose.h"
#include "solvers/stepper.h"
#include "tests/random_nets.h"

using namespace springstab;
using namespace springstab::test;
using boost::test_tools::tolerance;

namespace {

const double infinity = std::numeric_limits<double>::infinity();

const HalfPlane& symplectic_condition() {
  static const HalfPlane condition = stability_region("symplectic-euler").exact_condition().value();
  return condition;
}

Eigen::MatrixXd mass_scaled_dense(const SparseMatrix& a, const StructuralMatrices& s) {
  const Eigen::VectorXd d = Eigen::MatrixXd(s.mass).diagonal().cwiseSqrt().cwiseInverse();
  return d.asDiagonal() * Eigen::MatrixXd(a) * d.asDiagonal();
}

/// 1/h* from the other form of theory 4b: with K' = BBᵀ, the largest eigenvalue of [[D'/2, B/2], [Bᵀ/2, 0]].
double symplectic_truth(const StructuralMatrices& s) {
  const Eigen::Index n = s.size();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> k(mass_scaled_dense(s.stiffness, s));
  const Eigen::MatrixXd b =
      k.eigenvectors() * k.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal().toDenseMatrix();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  both.topLeftCorner(n, n) = mass_scaled_dense(s.damping, s) / 2;
  both.topRightCorner(n, n) = b / 2;
  both.bottomLeftCorner(n, n) = b.transpose() / 2;
  return 1 / Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(both, Eigen::EigenvaluesOnly)
                 .eigenvalues()
                 .tail<1>()[0];
}

}  // namespace

BOOST_AUTO_TEST_SUITE(certified_step)

BOOST_AUTO_TEST_CASE(symplectic_euler_is_exact_and_the_others_are_not) {
  for (const MethodInfo& method : all_methods())
    BOOST_TEST(stability_region(method.name).exact_condition().has_value() ==
               (method.name == "symplectic-euler"));
  BOOST_TEST(symplectic_condition().x == 2);
  BOOST_TEST(symplectic_condition().y == 1);
  BOOST_TEST(symplectic_condition().bound == 4);
}

BOOST_AUTO_TEST_CASE(symplectic_eulers_limit_is_the_dense_truth) {
  RandomNets random(1);
  int damped = 0;
  for (int i = 0; i < 300; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(i % 2 == 0), i % 3 == 0 ? 0.5 : 0);
      const double h = exact_limit(NumericalRange(s), symplectic_condition()).value();
      BOOST_TEST(h == symplectic_truth(s), tolerance(1e-9));
      damped += h < 0.99 * 2 / std::sqrt(stiffest_mode(s).value);

      DefinitenessProof proof(s);
      const double certified = proved_limit(proof, symplectic_condition(), h).value();
      BOOST_TEST(certified < h);
      BOOST_TEST(certified > (1 - 1e-6) * h);
      // Mechanisms (K v = D v = 0) have the double eigenvalue 1, which rounding moves by √ε of A's entries.
      BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", (1 - 1e-3) * h)) <= 1 + 1e-6);
      BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", (1 + 1e-3) * h)) > 1 + 1e-5);
    }
  BOOST_TEST(damped > 100);  // the damping mattered
}

BOOST_AUTO_TEST_CASE(large_nets_have_the_limit_of_small_ones) {
  SpringNet net = make_net(Grid{8, 9, 0.1}, {.damping = {0.05, 0.02, 0.01}});
  const StructuralMatrices s = matrices(net);
  BOOST_TEST(s.size() > dense_limit);
  const double h = exact_limit(NumericalRange(s), symplectic_condition()).value();
  BOOST_TEST(h == symplectic_truth(s), tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(consistent_masses_change_nothing) {
  RandomNets random(2);
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      StructuralMatrices s = matrices(random.net(true));
      const double lumped = exact_limit(NumericalRange(s), symplectic_condition()).value();
      // A congruence, with L lower triangular, leaves the limit as it is.
      Eigen::MatrixXd l = Eigen::MatrixXd::Identity(s.size(), s.size());
      for (Eigen::Index j = 1; j < s.size(); ++j) l(j, j - 1) = random.uniform(-0.5, 0.5);
      for (SparseMatrix* a : {&s.stiffness, &s.mass, &s.damping})
        *a = (l * Eigen::MatrixXd(*a) * l.transpose()).sparseView(0.0, 0.0);
      BOOST_TEST(!is_diagonal(s.mass));
      BOOST_TEST(exact_limit(NumericalRange(s), symplectic_condition()).value() == lumped, tolerance(1e-9));
      BOOST_TEST(proved_limit(s, symplectic_condition()).value() < lumped);
      BOOST_TEST(proved_limit(s, symplectic_condition()).value() > (1 - 1e-6) * lumped);
    }
}

BOOST_AUTO_TEST_CASE(limits_scale_with_the_unit_of_time) {
  RandomNets random(3);
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(true));
      const StiffestMode k0 = stiffest_mode(s);
      const DampingModel general{DampingModel::Kind::general, 0, 0, true};
      for (const double unit : {1e9, 1e-9}) {
        const StructuralMatrices t = in_unit(s, unit);
        const StiffestMode k0_t = stiffest_mode(t);
        GeneralDamping one(s, k0, general, 1.5, true), other(t, k0_t, general, 1.5, true);
        for (const MethodInfo& method : all_methods()) BOOST_TEST_CONTEXT(method.name) {
            const MethodLimits a = one.limits(method.name), b = other.limits(method.name);
            BOOST_TEST((a.status == b.status));
            for (const auto member :
                 {&MethodLimits::h_max, &MethodLimits::h_certified, &MethodLimits::recommended}) {
              BOOST_TEST((a.*member).has_value() == (b.*member).has_value());
              if (a.*member && std::isfinite(*(a.*member)))
                BOOST_TEST(*(b.*member) * unit == *(a.*member), tolerance(1e-9));
            }
          }
      }
    }
}

BOOST_AUTO_TEST_CASE(the_recommended_step_survives_stiffening) {
  RandomNets random(4);
  for (int i = 0; i < 30; ++i) BOOST_TEST_CONTEXT("net " << i) {
      StructuralMatrices s = matrices(random.net(true));
      const double alpha = i % 2 == 0 ? 0 : random.log_uniform(-5, -3), safety = 1.5;
      s.damping += alpha * s.stiffness;
      const StiffestMode k0 = stiffest_mode(s);
      GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, alpha, true}, safety, false);
      const MethodLimits limits = general.limits("symplectic-euler");
      double expected = symplectic_truth(s);
      StructuralMatrices stiffer = s;
      stiffer.stiffness *= safety;
      expected = std::min(expected, symplectic_truth(stiffer));
      stiffer.damping += (safety - 1) * alpha * s.stiffness;
      expected = std::min(expected, symplectic_truth(stiffer));
      BOOST_TEST(limits.recommended.value() == expected, tolerance(1e-9));
      BOOST_TEST(expected < *limits.h_max);
    }
}

BOOST_AUTO_TEST_CASE(a_step_for_every_pose_is_stable_in_each) {
  RandomNets random(5);
  for (int i = 0; i < 60; ++i) BOOST_TEST_CONTEXT("net " << i) {
      SpringNet net = random.net(false);
      const double d0 = i % 2 == 0 ? 0 : 3;
      const double h = proved_limit(every_pose(net, {0}, {d0, 0}), symplectic_condition()).value();
      double least = infinity;
      for (int pose = 0; pose < 5; ++pose) {
        SpringNet posed = net;
        for (Eigen::Vector3d& p : posed.rest)  // far apart: stretched springs, K semidefinite
          p = 1e3 * Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        least = std::min(least, symplectic_truth(matrices(posed, d0)));
      }
      BOOST_TEST(h <= least);
      BOOST_TEST(h > 0.5 * least);
    }
}

BOOST_AUTO_TEST_CASE(nothing_is_said_of_structures_that_grow_by_themselves) {
  RandomNets random(6);
  const StructuralMatrices s = matrices(random.net(true));
  StiffestMode k0 = stiffest_mode(s);
  DampingModel general{DampingModel::Kind::general, 0, 0, false};
  for (const MethodInfo& method : all_methods()) {
    BOOST_TEST(
        (GeneralDamping(s, k0, general, 1.5, true).limits(method.name).status == LimitStatus::unknown));
    k0.indefinite = true;
    general.semidefinite = true;
    BOOST_TEST(
        (GeneralDamping(s, k0, general, 1.5, true).limits(method.name).status == LimitStatus::unknown));
    k0.indefinite = false;
    general.semidefinite = false;
  }
}

BOOST_AUTO_TEST_SUITE_END()
