// The laws of stable steps under damping that does not commute with the stiffness: exact where a condition is
// exact for matrices, proved otherwise, and never above the truth of dense eigenvalues.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/structure_limits.h"
#include "analysis/method.h"
#include "analysis/proofs/step_magnitude.h"
#include "analysis/spectra/generator_spectrum.h"
#include "analysis/spectra/rigid_motions.h"
#include "analysis/spectra/spectrum.h"
#include "solvers/io/matrix_file.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/methods/explicit_runge_kutta.h"
#include "solvers/scene/every_pose.h"
#include "tests/instruments.h"
#include "tests/random_nets.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(certified_step)

using namespace springstab;
using namespace springstab::test;
using boost::test_tools::tolerance;

namespace {

const double infinity = std::numeric_limits<double>::infinity();

const HalfPlane& symplectic_condition() {
  static const HalfPlane condition = stability_region("symplectic-euler").exact_condition().value();
  return condition;
}

SparseMatrix diagonal(const std::vector<double>& d) {
  const Eigen::Map<const Eigen::VectorXd> entries(d.data(), static_cast<Eigen::Index>(d.size()));
  return SparseMatrix(entries.asDiagonal());
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

using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// The generator's eigenvalues over √‖K'‖ [1/s], of matrices with a diagonal mass.
Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, 1> long_eigenvalues(const StructuralMatrices& s,
                                                                             long double& rate) {
  const Eigen::Index n = s.size();
  const Eigen::Matrix<long double, Eigen::Dynamic, 1> root =
      Eigen::MatrixXd(s.mass).diagonal().cast<long double>().cwiseSqrt().cwiseInverse();
  const auto mass_scaled_long = [&](const SparseMatrix& a) {
    return Long(root.asDiagonal() * Eigen::MatrixXd(a).cast<long double>() * root.asDiagonal());
  };
  const Long k = mass_scaled_long(s.stiffness);
  rate = std::sqrt(k.norm());
  Long generator = Long::Zero(2 * n, 2 * n);
  generator.topRightCorner(n, n).setIdentity();
  generator.bottomLeftCorner(n, n) = -k / (rate * rate);
  generator.bottomRightCorner(n, n) = -mass_scaled_long(s.damping) / rate;
  return Eigen::EigenSolver<Long>(generator, false).eigenvalues();
}

/// Every eigenvalue of the generator in turn; those at rounding level are rigid motions. `known`: long
/// doubles tell each real part from rounding.
double dense_truth(const StructuralMatrices& s, std::string_view method, bool* known = nullptr) {
  long double rate = 0;
  double h = infinity;
  if (known) *known = true;
  for (const std::complex<long double> mu : long_eigenvalues(s, rate))
    if (std::abs(mu) > 1e-6) {
      const double d = static_cast<double>(-2 * mu.real());
      if (known && !(d > 1e-12)) *known = false;
      h = std::min(
          h, stability_region(method).critical_step(static_cast<double>(std::norm(mu)), std::max(0.0, d)));
    }
  return h / static_cast<double>(rate);
}

std::optional<double> by_polygons(const StructuralMatrices& s, std::string_view method) {
  return CertifiedSteps(s).certified(method);
}

/// All that `limits` can prove.
std::optional<double> by_any_proof(const StructuralMatrices& s, std::string_view method) {
  const StiffestMode k0 = stiffest_mode(s);
  const MethodLimits limits =
      GeneralDamping(s, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true).limits(method);
  if (limits.h_certified) BOOST_TEST((limits.proof != Proof::none && limits.unproved.empty()));
  return limits.h_certified;
}

/// certified/true over random nets, ascending; 0 where nothing was certified, 1 where there is no stable
/// step.
template <class Certify>
std::vector<double> certified_shares(const Certify& certify, std::string_view method, std::uint64_t seed,
                                     int count, const std::function<StructuralMatrices(RandomNets&)>& make) {
  RandomNets random(seed);
  std::vector<double> shares;
  for (int i = 0; i < count; ++i) BOOST_TEST_CONTEXT(method << ", net " << i) {
      const StructuralMatrices s = make(random);
      bool known = false;
      const double truth = dense_truth(s, method, &known);
      const double certified = certify(s, method).value_or(0);
      BOOST_TEST(certified <= truth);
      const auto estimate = critical_step(method, generator_spectrum(s).value());
      if (estimate && (known || method == "rk4")) BOOST_TEST(*estimate == truth, tolerance(1e-5));
      if (certified > 0) BOOST_TEST(largest_modulus(transition_matrix(s, method, certified)) <= 1 + 1e-6);
      shares.push_back(truth > 0 ? certified / truth : 1);
    }
  std::sort(shares.begin(), shares.end());
  BOOST_TEST_MESSAGE(method << ": certified/true is " << shares[shares.size() / 2]
                            << " in the median, 5 % below " << shares[shares.size() / 20] << ", of " << count
                            << " nets");
  return shares;
}

}  // namespace

BOOST_AUTO_TEST_CASE(symplectic_euler_is_exact_and_the_others_are_not) {
  for (const Method& method : all_methods())
    BOOST_TEST(stability_region(method.name()).exact_condition().has_value() ==
               (method.name() == "symplectic-euler"));
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
      const double certified = proved_limit(proof.test(), symplectic_condition(), h).value();
      BOOST_TEST(certified < h);
      BOOST_TEST(certified > (1 - 1e-6) * h);
      // Mechanisms (K v = D v = 0) have the double eigenvalue 1, which rounding moves by √ε of A's entries.
      BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", (1 - 1e-3) * h)) <= 1 + 1e-6);
      BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", (1 + 1e-3) * h)) > 1 + 1e-5);
    }
  BOOST_TEST(damped > 100);  // the damping mattered
}

// However little ARPACK may do: what does not converge is no step, what converges is the truth. The largest
// eigenvalues of a chain lie close.
BOOST_AUTO_TEST_CASE(unconverged_eigenvalues_never_become_a_step, *boost::unit_test::label("slow")) {
  RandomNets random(20);
  SpringNet chain;
  for (int i = 0; i <= 60; ++i) {
    chain.rest.emplace_back(i, 0, 0);
    chain.mass.push_back(1);
    if (i > 0) chain.springs.push_back({i - 1, i, 1, random.uniform(0.1, 0.2), 0.5});
  }
  const StructuralMatrices s = matrices(chain);
  BOOST_TEST(s.size() > dense_limit);
  const DampingModel damping{DampingModel::Kind::general, 0, 0, true};
  const StiffestMode k0 = stiffest_mode(s);
  const double symplectic = symplectic_truth(s), rk4 = dense_truth(s, "rk4");
  int none = 0, some = 0;
  for (const Eigen::Index basis : {3, 6, 12})
    for (const int restarts : {1, 2, 3, 5, 8, 13, 21})
      BOOST_TEST_CONTEXT(basis << " vectors, " << restarts << " restarts") {
        const ArpackOptions options{.basis_size = basis, .max_restarts = restarts};
        const StiffestMode mode = stiffest_mode(s, options);
        if (mode.converged) BOOST_TEST(mode.value == k0.value, tolerance(1e-9));
        GeneralDamping of_that_mode(s, mode, damping, 1.5, true, options);
        if (!mode.converged) BOOST_TEST((of_that_mode.limits("rk4").status == LimitStatus::unknown));

        const std::optional<double> h = exact_limit(NumericalRange(s, options), symplectic_condition());
        if (h) BOOST_TEST(*h == symplectic, tolerance(1e-6));
        const std::optional<double> proved = proved_limit(s, symplectic_condition(), options);
        BOOST_TEST(proved.value_or(0) <= symplectic);
        GeneralDamping general(s, k0, damping, 1.5, true, options);
        const MethodLimits exact = general.limits("symplectic-euler"), polygon = general.limits("rk4");
        BOOST_TEST((exact.h_max.has_value() || !exact.h_certified));
        BOOST_TEST(exact.h_certified.value_or(0) <= symplectic);
        BOOST_TEST(exact.recommended.value_or(0) < symplectic);
        BOOST_TEST(polygon.h_certified.value_or(0) <= rk4);
        BOOST_TEST(polygon.recommended.value_or(0) < rk4);
        ++(h ? some : none);
      }
  BOOST_TEST_MESSAGE("not converged: " << none << ", converged: " << some);
  BOOST_TEST((none > 0 && some > 0));
}

// K and D of diagonal matrices are proved by their diagonals alone, whatever their size.
BOOST_AUTO_TEST_CASE(too_many_unknowns_to_factorize_is_the_reason_given, *boost::unit_test::label("slow")) {
  const Eigen::Index n = SparseCholesky::unknowns_limit + 1;
  std::vector<double> k(n, 1), d(n, 1);
  k[0] = 100, d[1] = 10;
  k[3] = 10, d[3] = 0.05;  // neither the stiffest nor the most damped
  const StructuralMatrices s = prepare(diagonal(k), {}, diagonal(d));
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST(k0.value == 100, tolerance(1e-9));
  BOOST_TEST((k0.bound_kind == BoundKind::gershgorin));
  GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true);
  for (const std::string_view method : {"symplectic-euler", "rk4"}) BOOST_TEST_CONTEXT(method) {
      const StabilityRegion& region = stability_region(method);
      const double truth = std::min(region.critical_step(100, 1), region.critical_step(1, 10));
      const double certified = general.limits(method).h_certified.value();
      BOOST_TEST(certified <= truth);
      BOOST_TEST(certified >= 0.99 * truth);
    }
  // An edge through the origin holds by what couples the particles, which here is nothing: d >= 0.005 k,
  const double certified = general.limits("explicit-euler").h_certified.value();
  BOOST_TEST(certified <= 0.005);
  BOOST_TEST(certified >= 0.999 * 0.005);
  // or but for rigid motions, which a factorization would have to find.
  d[2] = 0;
  const StructuralMatrices undamped = prepare(diagonal(k), {}, diagonal(d));
  GeneralDamping of_undamped(undamped, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true);
  BOOST_TEST(!of_undamped.limits("explicit-euler").h_certified);
  BOOST_TEST(of_undamped.limits("explicit-euler").unproved ==
             "there are too many unknowns to factorize a matrix");
  BOOST_TEST(!general.growth());
  BOOST_TEST(!generator_spectrum(s));
  BOOST_TEST(!damped_modes(s));
}

// Rotors of many unknowns: eigenvalues alone could decide, and they are not computed.
BOOST_AUTO_TEST_CASE(many_unknowns_that_are_not_symmetric_have_no_limit) {
  const Eigen::Index n = generator_limit + 1;
  SparseMatrix k(n, n), d(n, n);
  k.setIdentity();
  k.coeffRef(0, 0) = 9;
  d.insert(0, 1) = 1;
  d.insert(1, 0) = -1;
  const StructuralMatrices s = prepare_nonsymmetric(k, {}, d);
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST(k0.value == 9, tolerance(1e-9));
  GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, 0, false}, 1.5, true);
  for (const Method& method : all_methods()) {
    const MethodLimits limits = general.limits(method.name());
    BOOST_TEST((limits.status == LimitStatus::unknown && !limits.h_max && !limits.h_certified));
    BOOST_TEST(limits.unproved == "K or D is not symmetric");
  }
  BOOST_TEST(!general.growth());
}

// Without springs the modes are first-order decays, d alone: a step is stable up to the end of the X axis.
BOOST_AUTO_TEST_CASE(dampers_alone_limit_the_step) {
  const StructuralMatrices s = prepare(SparseMatrix(3, 3), {}, diagonal({1, 2, 4}));
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST((k0.converged && k0.value == 0));
  GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true);
  for (const std::string_view method : {"symplectic-euler", "explicit-euler", "rk2", "rk4"})
    BOOST_TEST_CONTEXT(method) {
      const MethodLimits limits = general.limits(method);
      const double truth = stability_region(method).critical_step(0, 4);
      BOOST_TEST(limits.h_certified.value() <= truth);
      BOOST_TEST(limits.h_certified.value() >= 0.99 * truth);
      BOOST_TEST(limits.h_max.value() == truth, tolerance(1e-9));
    }
}

BOOST_AUTO_TEST_CASE(large_nets_have_the_limit_of_small_ones) {
  SpringNet net = make_net(Grid{8, 9, 0.1}, {.damping = {0.05, 0.02, 0.01}});
  const StructuralMatrices s = matrices(net);
  BOOST_TEST(s.size() > dense_limit);
  const double h = exact_limit(NumericalRange(s), symplectic_condition()).value();
  BOOST_TEST(h == symplectic_truth(s), tolerance(1e-9));
}

// Also where a coefficient is negative, and what bounds D' or K' from above bounds the sum from below.
BOOST_AUTO_TEST_CASE(the_farthest_point_of_large_nets_is_that_of_dense_matrices) {
  const StructuralMatrices s = matrices(make_net(Grid{8, 9, 0.1}, {.damping = {0.05, 0.02, 0.01}}));
  const Eigen::MatrixXd damping = mass_scaled_dense(s.damping, s),
                        stiffness = mass_scaled_dense(s.stiffness, s);
  const NumericalRange range(s);
  const double d = damping.norm(), k = stiffness.norm();
  for (const auto& [a, b] : {std::pair{0.0, 1.0},
                             {1.0, 0.0},
                             {1.0, 1.0},
                             {1.0, -1.0},
                             {0.3, -1.0},
                             {-1.0, 1.0},
                             {-0.3, 1.0},
                             {-1.0, 0.3},
                             {-1.0, 0.0}})
    BOOST_TEST_CONTEXT(a << " D' + " << b << " K'") {
      const Eigen::MatrixXd sum = a / d * damping + b / k * stiffness;
      const double truth = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(sum, Eigen::EigenvaluesOnly)
                               .eigenvalues()
                               .tail<1>()[0];
      const ExtremePoint p = range.farthest(a / d, b / k).value();
      BOOST_TEST(std::abs(a / d * p.d + b / k * p.k - truth) <= 1e-10);
    }
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

BOOST_AUTO_TEST_CASE(limits_scale_with_the_unit_of_time, *boost::unit_test::label("slow")) {
  RandomNets random(3);
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(true));
      const StiffestMode k0 = stiffest_mode(s);
      const DampingModel general{DampingModel::Kind::general, 0, 0, true};
      // A power of two rounds nothing; 1e9 does, and explicit Euler's limit is as accurate as Re μ, at worst
      // 1e-9 of the largest |μ|.
      for (const auto& [unit, error] :
           {std::pair{0x1p30, 1e-12}, {0x1p-30, 1e-12}, {1e9, 1e-5}, {1e-9, 1e-5}}) {
        const StructuralMatrices t = in_unit(s, unit);
        const StiffestMode k0_t = stiffest_mode(t);
        GeneralDamping one(s, k0, general, 1.5, true), other(t, k0_t, general, 1.5, true);
        for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
            const MethodLimits a = one.limits(method.name()), b = other.limits(method.name());
            BOOST_TEST((a.status == b.status));
            for (const auto member :
                 {&MethodLimits::h_max, &MethodLimits::h_certified, &MethodLimits::recommended}) {
              BOOST_TEST((a.*member).has_value() == (b.*member).has_value());
              if (a.*member && std::isfinite(*(a.*member)))
                BOOST_TEST(*(b.*member) * unit == *(a.*member), tolerance(error));
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
      double expected = symplectic_truth(s) / std::sqrt(safety);
      StructuralMatrices stiffer = s;
      stiffer.stiffness *= safety;
      expected = std::min(expected, symplectic_truth(stiffer));
      stiffer.damping += (safety - 1) * alpha * s.stiffness;
      expected = std::min(expected, symplectic_truth(stiffer));
      BOOST_TEST(limits.recommended.value() == expected, tolerance(1e-9));
      BOOST_TEST(expected < *limits.h_max);
    }
}

// By eigenvalues, of whichever stiffening limits most.
BOOST_AUTO_TEST_CASE(other_methods_recommended_steps_survive_stiffening) {
  RandomNets random(17);
  int by_damping = 0;
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      StructuralMatrices s = matrices(random.net(true));
      const double alpha = random.log_uniform(-3, -1), safety = 1.5;
      s.damping += alpha * s.stiffness;
      StructuralMatrices stiffer = s;
      stiffer.stiffness *= safety;
      StructuralMatrices damped = stiffer;
      damped.damping += (safety - 1) * alpha * s.stiffness;
      const StiffestMode k0 = stiffest_mode(s);
      GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, alpha, true}, safety, false);
      for (const std::string_view method : {"rk2", "rk4"}) {
        const double each[] = {dense_truth(s, method) / std::sqrt(safety), dense_truth(stiffer, method),
                               dense_truth(damped, method)};
        const double least = *std::min_element(std::begin(each), std::end(each));
        BOOST_TEST(general.limits(method).recommended.value() == least, tolerance(1e-5));
        by_damping += least < 0.9 * std::min(each[0], each[1]);
      }
    }
  BOOST_TEST(by_damping > 10);
}

// Where the first guess is far from what holds, a step in between is found that was proved.
BOOST_AUTO_TEST_CASE(a_proof_is_searched_far_below_a_wrong_guess) {
  RandomNets random(18);
  for (int i = 0; i < 30; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(i % 2 == 0));
      const double h = symplectic_truth(s);
      DefinitenessProof proof(s);
      for (const double guess : {1.1, 1.7, 20.0}) {
        const double proved = proved_limit(proof.test(), symplectic_condition(), guess * h).value();
        BOOST_TEST(proved < h);
        BOOST_TEST(proved >= (1 - 1e-3 * guess) * h);  // gaps of the guess
      }
    }
}

// Around modes all along the region's top: each side between its neighbours, and the way there from the
// origin.
BOOST_AUTO_TEST_CASE(fitted_polygons_lie_inside_the_region) {
  int sides = 0;
  for (const std::string_view method : {"explicit-euler", "rk2", "rk4", "symplectic-euler"})
    BOOST_TEST_CONTEXT(method) {
      const StabilityRegion& region = stability_region(method);
      std::vector<ModePoint> modes;
      for (const RegionPiece& piece : region.pieces(region.natural_window(0)))
        for (std::size_t i = 0; i < piece.x.size(); i += 8)
          if (piece.x[i] > 0.1 && piece.y_upper[i] > 0.1) modes.push_back({piece.x[i], piece.y_upper[i]});
      const PolygonFit fit = inscribed_polygons(method).fit(modes);
      std::vector<Eigen::Vector2d> corners;
      for (std::size_t i = 0; i + 1 < fit.edges.size(); ++i) {
        const HalfPlane &p = fit.edges[i], &q = fit.edges[i + 1];
        const Eigen::Matrix2d both{{p.x, p.y}, {q.x, q.y}};
        corners.emplace_back(both.fullPivLu().solve(Eigen::Vector2d(p.bound, q.bound)));
      }
      for (std::size_t i = 0; i + 1 < corners.size(); ++i, ++sides) {
        const Eigen::Vector2d &a = corners[i], &b = corners[i + 1];
        BOOST_TEST(region.closed_segment_is_stable(a.x(), a.y(), b.x(), b.y()));
        BOOST_TEST(region.closed_segment_is_stable(0, 0, a.x(), a.y()));
      }
    }
  BOOST_TEST_MESSAGE(sides << " sides");
  BOOST_TEST(sides > 16);
}

// Eigenvalues find what proofs do.
BOOST_AUTO_TEST_CASE(an_estimated_step_is_the_certified_one) {
  RandomNets random(19);
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(true));
      for (const std::string_view method : {"rk2", "rk4"}) {
        const auto certified = CertifiedSteps(s).certified(method),
                   estimated = CertifiedSteps(s).estimated(method, {});
        BOOST_TEST(certified.has_value() == estimated.has_value());
        if (certified && estimated) BOOST_TEST(*estimated == *certified, tolerance(2e-3));
      }
    }
}

// The largest a d + b k over the d, k >= 0 that the half-planes leave, from their corners.
double farthest_corner(std::vector<HalfPlane> sides, double a, double b) {
  sides.push_back({-1, 0, 0});
  sides.push_back({0, -1, 0});
  double most = 0;  // the origin
  for (const HalfPlane& p : sides)
    for (const HalfPlane& q : sides) {
      const double determinant = p.x * q.y - p.y * q.x;
      const double d = (p.bound * q.y - q.bound * p.y) / determinant;
      const double k = (q.bound * p.x - p.bound * q.x) / determinant;
      const auto within = [&](const HalfPlane& side) {
        const double size = std::abs(side.x * d) + std::abs(side.y * k) + side.bound;
        return side.x * d + side.y * k <= side.bound + 1e-12 * size;
      };
      if (std::isfinite(d) && std::isfinite(k) && std::ranges::all_of(sides, within))
        most = std::max(most, a * d + b * k);
    }
  return most;
}

BOOST_AUTO_TEST_CASE(what_follows_from_proved_half_planes_is_implied_and_nothing_beyond) {
  RandomNets random(8);
  int edges = 0, from_origin = 0;
  for (int trial = 0; trial < 400; ++trial) BOOST_TEST_CONTEXT(trial) {
      const double unit_d = random.log_uniform(-6, 6), unit_k = random.log_uniform(-8, 8);
      std::vector<HalfPlane> sides{{unit_d, 0, 1}, {0, unit_k, 1}};  // W is bounded
      const int more = static_cast<int>(random.uniform(0, 5));
      for (int i = 0; i < more; ++i) {
        const double c = random.uniform(0, 1) < 0.2 ? 0 : random.log_uniform(-2, 0);
        sides.push_back({random.uniform(-1, 1) * unit_d, random.uniform(0, 1) * unit_k, c});
      }
      ProvedHalfPlanes proved;
      for (const HalfPlane& side : sides) {
        const double scale = random.log_uniform(-3, 3);
        proved.add(scale * side.bound, scale * side.x, scale * side.y);
        const double room = side.bound == 0 && side.x < 0 ? 1 - 1e-9 : 1;  // where no bound has any
        BOOST_TEST(proved.imply(side.bound * (1 + 1e-9), side.x, room * side.y));
      }
      const double a = random.uniform(-1, 1) * unit_d, b = random.uniform(-0.1, 1) * unit_k;
      const double most = farthest_corner(sides, a, b);
      if (most > 1e-6) {
        ++edges;
        BOOST_TEST(proved.imply(most * (1 + 1e-9), a, b));
        BOOST_TEST(!proved.imply(most * (1 - 1e-9), a, b));
      } else if (most == 0) {
        ++from_origin;
        BOOST_TEST(proved.imply(1e-9, a, b));
      }
      for (const double wrong : {std::nan(""), infinity}) {
        BOOST_TEST(!proved.imply(1, wrong, b));
        BOOST_TEST(!proved.imply(1, a, wrong));
        BOOST_TEST(!proved.imply(wrong, a, b));
      }
      BOOST_TEST(!proved.imply(-1e-9, a, b));
    }
  BOOST_TEST(edges > 100);
  BOOST_TEST(from_origin > 20);
  BOOST_TEST(!ProvedHalfPlanes().imply(1, 1, 1));
}

BOOST_AUTO_TEST_CASE(what_was_proved_is_not_proved_again) {
  RandomNets random(21);
  for (int trial = 0; trial < 10; ++trial) BOOST_TEST_CONTEXT(trial) {
      const StructuralMatrices s = without_rigid_motions(matrices(random.net(false)));
      if (!s.has_damping()) continue;
      DefinitenessProof proof(s);
      int asked = 0;
      CertifiedSteps steps(std::make_shared<const NumericalRange>(s), [&](double c, double a, double b) {
        ++asked;
        return proof.holds(c, a, b);
      });
      const std::optional<double> h = steps.certified("rk4");
      const int once = asked;
      BOOST_REQUIRE(h.has_value());
      BOOST_TEST(steps.certified("rk4").value() >= *h * (1 - 1e-12));
      BOOST_TEST(asked == once);
      BOOST_TEST(*h <= dense_truth(s, "rk4"));
    }
}

BOOST_AUTO_TEST_CASE(a_coupling_ratio_proves_edges_through_the_origin_and_no_others) {
  const StructuralMatrices s = prepare(diagonal({100, 1, 10}), {}, diagonal({1, 10, 0.05}));
  const auto range = std::make_shared<const NumericalRange>(s);
  DefinitenessProof proof(&s);
  for (const double ratio : {0.001, 0.002, 0.005}) {
    const double h = CertifiedSteps(range, proof.test(), ratio).certified("explicit-euler").value();
    BOOST_TEST(h <= ratio);
    BOOST_TEST(h >= 0.999 * ratio);
  }
  BOOST_TEST(!CertifiedSteps(range, proof.test(), 0).certified("explicit-euler"));
  const DefinitenessTest nothing = [](double, double, double) { return false; };
  BOOST_TEST(!CertifiedSteps(range, nothing, 0.005).certified("explicit-euler"));
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

constexpr int nets = test::times(200, 20);

BOOST_AUTO_TEST_CASE(certified_steps_are_below_the_truth_on_any_net) {
  int i = 0;
  const auto any = [&](RandomNets& random) { return matrices(random.net(i++ % 2 == 0)); };
  for (const Method& method : all_methods()) {
    const StabilityRegion& region = stability_region(method.name());
    if (region.exact_condition() || region.constants().covers_quadrant || method.info().linearized) continue;
    const std::vector<double> shares = certified_shares(by_polygons, method.name(), 7, nets, any);
    if (method.name() == "rk4") {
      BOOST_TEST(shares[nets / 2] >= 0.98);
      BOOST_TEST(shares[0] >= 0.5);
    }
  }
}

BOOST_AUTO_TEST_CASE(certified_steps_are_sharp_where_dampers_resist_what_springs_do) {
  const auto damped = [](RandomNets& random) {
    SpringNet net = random.net(false);
    const double time = random.log_uniform(-3, -1);
    for (Spring& spring : net.springs) spring.damping = time * spring.stiffness * random.uniform(0.5, 2);
    return matrices(net);
  };
  const std::vector<double> rk2 = certified_shares(by_polygons, "rk2", 8, nets, damped);
  BOOST_TEST(rk2[nets / 2] >= 0.8);
  BOOST_TEST(rk2[nets / 20] >= 0.5);
  const std::vector<double> euler = certified_shares(by_polygons, "explicit-euler", 9, nets, damped);
  BOOST_TEST(euler[0] > 0);
  BOOST_TEST(euler[nets / 2] >= 0.98);
  BOOST_TEST(euler[nets / 20] >= 0.5);
  const std::vector<double> rk4 = certified_shares(by_polygons, "rk4", 10, nets, damped);
  BOOST_TEST(rk4[nets / 2] >= 0.98);
}

// Where every mode loses 1e-10 of its size in a step, which rounding does not hide beside 1e-9 of the fastest
// rate, nearly the largest step
// is proved.
BOOST_AUTO_TEST_CASE(a_lyapunov_matrix_proves_what_polygons_do_not, *boost::unit_test::label("slow")) {
  for (const std::string_view method : {"explicit-euler", "rk2", "rk4"}) {
    int i = 0;
    const auto any = [&](RandomNets& random) {
      while (true) {
        StructuralMatrices s = matrices(random.net(i++ % 2 == 0));
        const std::vector<std::complex<double>> modes = generator_spectrum(s).value();
        double decay = infinity, largest = 0;
        for (const std::complex<double> mu : modes) {
          decay = std::min(decay, -mu.real());
          largest = std::max(largest, std::abs(mu));
        }
        if (decay > 1e-9 * largest && decay * critical_step(method, modes).value_or(0) > 1e-10) return s;
      }
    };
    const std::vector<double> shares = certified_shares(by_any_proof, method, 7, 200, any);
    BOOST_TEST(shares[0] > 0);
    BOOST_TEST(shares[10] >= 0.9);
    BOOST_TEST(shares[100] >= 0.999);
  }
}

// Nothing that a step computes exceeds what it adds up; explicit Euler's is [[1, 1], [|K|, 1 + |D|]].
BOOST_AUTO_TEST_CASE(the_magnitude_of_a_step_bounds_its_transition_matrix) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr Eigen::Index n = 4;
  const auto symmetric = [&] {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(engine); });
    return Eigen::MatrixXd(a + a.transpose());
  };
  int bounded = 0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd any = symmetric(), more = symmetric(), k = any * any, d = more * more;
    const StructuralMatrices s{.stiffness = k.sparseView(0.0, 0.0),
                               .mass = Eigen::MatrixXd::Identity(n, n).sparseView(),
                               .damping = d.sparseView(0.0, 0.0)};
    for (const Method& each : built_in_methods())
      if (const auto magnitude = each.magnitude(k, d)) {
        const Eigen::MatrixXd a = transition_matrix(s, each.name(), 1);
        BOOST_TEST((a.cwiseAbs().array() <= magnitude->array() * (1 + 1e-14)).all());
        ++bounded;
      }
    const Eigen::MatrixXd euler = Method("explicit-euler").magnitude(k, d).value();
    BOOST_TEST((euler.bottomLeftCorner(n, n) == k.cwiseAbs()));
    BOOST_TEST((euler.bottomRightCorner(n, n) - Eigen::MatrixXd::Identity(n, n)).isApprox(d.cwiseAbs()));
    BOOST_TEST(euler.topRows(n).sum() == 2 * n);
  }
  BOOST_TEST(bounded == 20 * static_cast<int>(built_in_methods().size()));
  // 1 + D + K has no factor
  BOOST_TEST(!Method("implicit-euler").magnitude(-9 * Eigen::MatrixXd::Identity(n, n), symmetric()));
}

// Kutta's third-order method has a coefficient of -1, and a step may subtract: with K = 0, D = 1 the sizes
// are v2 = 3/2, v3 = 1 + 1 + 2·3/2 = 5, v = 1 + (1 + 4·3/2 + 5)/6 = 3; a difference 1 - ½·1 counts as 3/2.
struct Kutta {
  MethodInfo info() const { return {"kutta", "Kutta", 3, false}; }
  template <class V>
  using Steps =
      ExplicitRungeKutta<V, ExplicitTableau<3>{.a = {{{}, {0.5}, {-1, 2}}}, .b = {1. / 6, 2. / 3, 1. / 6}}>;
};

struct Subtracting {
  MethodInfo info() const { return {"subtracting", "subtracting", 1, false}; }
  template <class V>
  struct Steps {
    StepStatus step(MagnitudeSystem& system, double h, State<V>& state) {
      V a{}, x = state.x;
      system.acceleration(state.x, state.v, a);
      V v = state.v - (0.5 * h) * a;
      return commit(state, x, v);
    }
  };
};

BOOST_AUTO_TEST_CASE(magnitudes_do_not_cancel) {
  const Eigen::MatrixXd k = Eigen::MatrixXd::Zero(1, 1), d = Eigen::MatrixXd::Ones(1, 1);
  BOOST_TEST((*step_magnitude(Kutta(), {k, d, k, d}))(1, 1) == 3, boost::test_tools::tolerance(1e-15));
  BOOST_TEST((*step_magnitude(Subtracting(), {k, d, k, d}))(1, 1) == 1.5);
}

// Nor all that is: not a step in which a mode hardly damped decays by no more than rounding.
BOOST_AUTO_TEST_CASE(no_lyapunov_matrix_proves_what_is_not_stable) {
  RandomNets random(14);
  int proved = 0, tried = 0;
  for (int i = 0; i < test::times(100, 10); ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(i % 2 == 0));
      for (const std::string_view method : {"explicit-euler", "rk2", "rk4"})
        if (const auto h = critical_step(method, generator_spectrum(s).value())) {
          const LyapunovSteps steps(s);
          if (*h * std::sqrt(stiffest_mode(s).value) > 1e-3) {
            proved += steps.proves(method, 0.99 * *h);
            ++tried;
          }
          for (const double above : {1 + 1e-6, 1.001, 1.5}) BOOST_TEST(!steps.proves(method, above * *h));
        }
    }
  BOOST_TEST(proved > 0.9 * tried);
  BOOST_TEST(tried > test::times(200, 20));
}

BOOST_AUTO_TEST_CASE(no_lyapunov_matrix_proves_what_it_cannot_see) {
  RandomNets random(17);
  const StructuralMatrices s = matrices(random.net(true), 0.5);
  const double h = critical_step("rk4", generator_spectrum(s).value()).value();
  const LyapunovSteps steps(s);
  BOOST_TEST(steps.proves("rk4", 0.9 * h));
  for (const char* name : {"implicit-euler", "newmark", "bdf2", "tr-bdf2"})
    BOOST_TEST(steps.proves(name, 0.9 * h), name);
  BOOST_TEST(steps.certified("rk4", 0, h).value() < h);
  BOOST_TEST(!steps.certified("rk4", h, h));         // nothing lies above what is known
  BOOST_TEST(!steps.certified("rk4", 0, 1000 * h));  // nor anything stable near that

  StructuralMatrices consistent = s, undamped = s;
  consistent.mass.coeffRef(0, 1) = consistent.mass.coeffRef(1, 0) = 0.1 * s.mass.coeff(0, 0);
  undamped.damping = {};
  const StructuralMatrices many = matrices(make_net(Grid{8, 9, 0.1}, {.damping = {0.05, 0.02, 0.01}}));
  BOOST_TEST(many.size() > LyapunovSteps::unknowns_limit);
  for (const StructuralMatrices* other : {&std::as_const(consistent), &std::as_const(undamped), &many})
    BOOST_TEST(!LyapunovSteps(*other).proves("rk4", 1e-3 * h));

  // A motion that dampers alone resist has no energy of its own to fall.
  const StructuralMatrices soft = prepare(diagonal({1, 0}), {}, diagonal({0, 1}));
  BOOST_TEST(!LyapunovSteps(soft).proves("rk4", 0.1));
}

// Springs alone hold a stretched flat net sideways; what D has there is rounding, and allows no step.
BOOST_AUTO_TEST_CASE(damping_of_roundings_size_allows_no_step) {
  SpringNet net = make_net(Grid{4, 5, 0.1}, {.damping = {0.05, 0.02, 0.01}});
  for (Eigen::Vector3d& p : net.rest)
    p = 1.1 * (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()) * p);
  const StructuralMatrices s = matrices(net);
  const StiffestMode k0 = stiffest_mode(s);
  GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true);
  for (const std::string_view method : {"explicit-euler", "rk2"}) {
    const MethodLimits limits = general.limits(method);
    BOOST_TEST((!limits.h_max && !limits.h_certified && !limits.recommended));
  }
  BOOST_TEST(general.limits("rk4").h_certified.value() > 0.9 * general.limits("rk4").h_max.value());
}

SpringNet damped_sheet(RandomNets& random, int rows, int columns) {
  SpringNet net = make_net(Grid{rows, columns, 0.1}, {.damping = {0.05, 0.02, 0.01}});
  for (Spring& spring : net.springs) {
    spring.stiffness *= random.log_uniform(-1, 1);
    spring.damping = spring.stiffness * random.log_uniform(-4, -3);
  }
  for (Eigen::Vector3d& p : net.rest)
    p += 0.03 * Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  for (Spring& spring : net.springs)
    spring.rest_length = random.uniform(0.9, 1) * (net.rest[spring.i] - net.rest[spring.j]).norm();
  return net;
}

BOOST_AUTO_TEST_CASE(modes_near_a_shift_are_those_of_the_whole_spectrum) {
  RandomNets random(15);
  int found = 0;
  for (int i = 0; i < test::times(10, 2); ++i) BOOST_TEST_CONTEXT("sheet " << i) {
      const StructuralMatrices s = matrices(damped_sheet(random, 5, 6));
      const std::vector<std::complex<double>> all = generator_spectrum(s).value();
      const std::complex<double> shift =
          all[static_cast<std::size_t>(random.uniform(0, static_cast<double>(all.size())))] *
          std::polar(1.001, 0.001);
      for (const std::complex<double> mu : modes_near(s, shift, 6)) {
        double nearest = infinity;
        for (const std::complex<double> other : all) nearest = std::min(nearest, std::abs(mu - other));
        BOOST_TEST(nearest <= 1e-6 * std::abs(mu));
        ++found;
      }
    }
  BOOST_TEST(found >= test::times(40, 8));
}

BOOST_AUTO_TEST_CASE(modes_near_a_shift_need_no_damping_and_no_luck) {
  const StructuralMatrices s = prepare(diagonal({1, 4, 9, 16, 25, 36, 49, 64, 81, 100}));
  const auto modes = modes_near(s, {0, 4.1}, 4);
  BOOST_TEST(modes.size() >= 2);
  for (const std::complex<double> mu : modes) {
    BOOST_TEST(std::abs(mu.real()) <= 1e-8);
    BOOST_TEST(std::abs(mu.imag() - std::round(mu.imag())) <= 1e-8);
    BOOST_TEST(std::abs(std::abs(mu.imag()) - 4) <= 2);
  }
  BOOST_TEST(modes_near(s, {0, 4}, 4).empty());  // an eigenvalue itself: the shifted matrix is singular
}

// Each solves its own equation of one unknown, and the net's rigid motions are not among them.
BOOST_AUTO_TEST_CASE(damped_modes_solve_what_they_see_of_the_matrices) {
  RandomNets random(18);
  int rigid = 0;
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(i % 2 == 0));
      const std::vector<DampedMode> modes = damped_modes(s).value();
      const double rate = std::sqrt(stiffest_mode(s).value);
      rigid += modes.size() < 2 * static_cast<std::size_t>(s.size());
      for (const DampedMode& mode : modes) {
        BOOST_TEST(std::abs(mode.mu * mode.mu + mode.d * mode.mu + mode.k) <= 1e-6 * rate * rate);
        BOOST_TEST(std::abs(mode.mu) > 1e-7 * rate);
      }
    }
  BOOST_TEST(rigid > 5);
}

// Against steps tried one after the other.
BOOST_AUTO_TEST_CASE(a_half_plane_is_left_where_its_inequality_fails) {
  RandomNets random(19);
  for (int i = 0; i < 2000; ++i) {
    const auto any = [&] { return random.uniform(0, 1) < 0.3 ? 0 : random.uniform(-1, 1); };
    const HalfPlane edge{any(), any(), std::abs(any())};
    const ModePoint p{std::abs(any()), std::abs(any())};
    const double h = exit_step(edge, p);
    const auto outside = [&](double step) {
      return edge.x * step * p.d + edge.y * step * step * p.k - edge.bound;
    };
    BOOST_TEST_CONTEXT(edge.x << ' ' << edge.y << ' ' << edge.bound << ", d " << p.d << ", k " << p.k) {
      BOOST_TEST(h >= 0);
      for (double step = 1e-3; step < 1e3; step *= 1.5) {
        if (step < h) BOOST_TEST(outside(step) <= 1e-9);
        if (h == 0 && step == 1e-3) BOOST_TEST(outside(step * 1e-6) > 0);
      }
      if (h > 0 && h < 1e6) BOOST_TEST(outside(h * (1 + 1e-6)) > -1e-12 * (1 + h * h));
    }
  }
}

// Above the size of dense eigenvalues the truth lies between what is proved and what is estimated.
BOOST_AUTO_TEST_CASE(estimates_of_large_sheets_enclose_the_truth, *boost::unit_test::label("slow")) {
  RandomNets random(16);
  int estimates = 0;
  for (int i = 0; i < 2; ++i) BOOST_TEST_CONTEXT("sheet " << i) {
      const StructuralMatrices s = matrices(damped_sheet(random, 9, 16));
      BOOST_TEST(s.size() > generator_limit);
      const StiffestMode k0 = stiffest_mode(s);
      GeneralDamping general(s, k0, {DampingModel::Kind::general, 0, 0, true}, 1.5, true);
      for (const std::string_view method : {"rk4", "rk2"}) {
        const MethodLimits limits = general.limits(method);
        if (!limits.h_max) continue;
        ++estimates;
        const double truth = dense_truth(s, method);
        BOOST_TEST((limits.source == LimitSource::estimate));
        BOOST_TEST(*limits.h_certified <= truth);
        BOOST_TEST(truth <= *limits.h_max * (1 + 1e-6));
        BOOST_TEST(*limits.h_certified >= 0.9 * *limits.h_max);
        BOOST_TEST(*limits.recommended < *limits.h_certified);  // that of the stiffened sheet
      }
    }
  BOOST_TEST(estimates >= 2);
}

// A net near a mechanism has small pivots that are not rounding, and rounding that is not small.
BOOST_AUTO_TEST_CASE(as_many_unknowns_are_held_as_there_are_rigid_motions) {
  RandomNets random(13);
  int fewer = 0;
  for (int i = 0; i < 1000; ++i) BOOST_TEST_CONTEXT("net " << i) {
      const StructuralMatrices s = matrices(random.net(false));
      const Eigen::MatrixXd k = mass_scaled_dense(s.stiffness, s), d = mass_scaled_dense(s.damping, s);
      Eigen::MatrixXd sum = k / k.diagonal().maxCoeff();
      if (!d.isZero(0)) sum += d / d.diagonal().maxCoeff();
      const Eigen::VectorXd scale = sum.diagonal().cwiseSqrt().cwiseInverse();
      sum = scale.asDiagonal() * sum * scale.asDiagonal();
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sum, Eigen::EigenvaluesOnly);
      const Eigen::Index rank = (solver.eigenvalues().array() > 1e-12).count();
      BOOST_TEST(without_rigid_motions(s).size() == rank);
      fewer += rank < s.size();
    }
  BOOST_TEST(fewer > 500);
}

BOOST_AUTO_TEST_CASE(rigid_motions_cut_no_certificate) {
  RandomNets random(11);
  for (int i = 0; i < 20; ++i) BOOST_TEST_CONTEXT("net " << i) {
      SpringNet flat = make_net(Grid{4, 5, 0.1}, {.damping = {0.05, 0.02, 0.01}});
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(random.uniform(0, 3), Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
      for (Eigen::Vector3d& p : flat.rest) p = turn * p;
      const StructuralMatrices s = matrices(flat);
      const StructuralMatrices rest = without_rigid_motions(s);
      const Eigen::MatrixXd stiffness(s.stiffness);
      Eigen::FullPivLU<Eigen::MatrixXd> factor(stiffness);
      factor.setThreshold(1e-10);
      const Eigen::Index rank = factor.rank();
      BOOST_TEST(rest.size() == rank);  // the dampers resist nothing that the springs do not
      BOOST_TEST(rest.size() < s.size());
      for (const std::string_view method : {"explicit-euler", "rk2"})
        BOOST_TEST(CertifiedSteps(s).certified(method).value_or(0) >= 0.3 * dense_truth(s, method));
    }
}

// Theory, Appendix B of the paper: implicit Euler is stable for every h where K is positive definite and D
// positive semidefinite, in the mass inner product; the matrices need not commute.
BOOST_AUTO_TEST_CASE(implicit_euler_is_stable_for_any_masses_stiffness_and_damping) {
  RandomNets random(12);
  for (int i = 0; i < 100; ++i) BOOST_TEST_CONTEXT("system " << i) {
      const Eigen::Index n = 2 + i % 7;
      const auto gram = [&](Eigen::Index rank) {
        Eigen::MatrixXd b(n, rank);
        for (double& entry : b.reshaped()) entry = random.uniform(-1, 1);
        return Eigen::MatrixXd(b * b.transpose());
      };
      Eigen::VectorXd mass(n);
      for (double& m : mass) m = random.log_uniform(-3, 3);
      const Eigen::MatrixXd k =
          random.log_uniform(-3, 6) * (gram(n) + 1e-3 * Eigen::MatrixXd::Identity(n, n));
      const Eigen::MatrixXd d = random.log_uniform(-3, 3) * gram(1 + i % static_cast<int>(n));
      const StructuralMatrices s =
          prepare(k.sparseView(0.0, 0.0), SparseMatrix(mass.asDiagonal()), d.sparseView(0.0, 0.0));
      const double omega = std::sqrt(stiffest_mode(s).value);
      for (const double h : {1e-2, 1.0, 1e2})
        BOOST_TEST(largest_modulus(transition_matrix(s, "implicit-euler", h / omega)) < 1 + 1e-9);
    }
}

// A rotor: undamped gyroscopic forces, D = -Dᵀ, move each frequency: ω⁴ - (k₁ + k₂ + g²) ω² + k₁k₂ = 0.
BOOST_AUTO_TEST_CASE(gyroscopic_forces_leave_the_eigenvalues_to_decide) {
  for (const double unit : {1.0, 1e9, 1e-9}) {
    const Eigen::Matrix2d k = unit * unit * Eigen::Matrix2d{{1, 0}, {0, 4}},
                          g = unit * Eigen::Matrix2d{{0, 3}, {-3, 0}};
    const StructuralMatrices s =
        prepare_nonsymmetric(k.sparseView(0.0, 0.0), SparseMatrix(), g.sparseView(0.0, 0.0));
    BOOST_TEST(!s.symmetric);
    const StiffestMode k0 = stiffest_mode(s);
    BOOST_TEST(k0.value == 4 * unit * unit, tolerance(1e-12));
    GeneralDamping general(s, k0, classify_damping(s), 1.5, true);
    const double omega = std::sqrt((14 + std::sqrt(14 * 14 - 16)) / 2) * unit;
    BOOST_TEST(general.growth().value() == 0);
    const MethodLimits rk4 = general.limits("rk4"), implicit = general.limits("implicit-euler");
    BOOST_TEST(rk4.h_max.value() == 2 * std::sqrt(2) / omega, tolerance(1e-9));
    BOOST_TEST((rk4.source == LimitSource::estimate));
    BOOST_TEST(rk4.unproved == "K or D is not symmetric");
    BOOST_TEST((implicit.status == LimitStatus::unlimited));
    BOOST_TEST(!implicit.h_certified);
    BOOST_TEST(!general.limits("explicit-euler").h_max);  // undamped
    BOOST_TEST((general.limits("symplectic-euler").status == LimitStatus::none));
  }
}

// A follower force couples two equal modes, K = [[2, 1], [-1, 2]]: μ = ±√(-2 ± i), two of which grow.
BOOST_AUTO_TEST_CASE(flutter_is_the_structures_own) {
  const Eigen::Matrix2d k{{2, 1}, {-1, 2}}, d = 1e-3 * Eigen::Matrix2d::Identity();
  const StructuralMatrices s =
      prepare_nonsymmetric(k.sparseView(0.0, 0.0), SparseMatrix(), d.sparseView(0.0, 0.0));
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST(k0.value == std::sqrt(5), tolerance(1e-12));
  BOOST_TEST(k0.residual <= 1e-14 * k0.value);
  GeneralDamping general(s, k0, classify_damping(s), 1.5, true);
  const std::complex<double> root = std::sqrt(std::complex<double>(1e-6 / 4 - 2, 1));
  BOOST_TEST(general.growth().value() == root.real() - 5e-4, tolerance(1e-12));
  const std::complex<double> other = -5e-4 - root;  // the mode that decays
  BOOST_TEST(general.limits("explicit-euler").h_max.value() == -2 * other.real() / std::norm(other),
             tolerance(1e-9));
  BOOST_CHECK_THROW(prepare(k.sparseView(0.0, 0.0)), std::invalid_argument);
}

// The limits that stand in the notes of that problem, whose K is not symmetric.
BOOST_AUTO_TEST_CASE(the_hospital_has_the_limits_of_its_notes) {
  const auto k = shared_data("matrices/nlevp_hospital_K.mtx"),
             d = shared_data("matrices/nlevp_hospital_D.mtx");
  if (!k || !d) return;
  const StructuralMatrices s =
      prepare_nonsymmetric(read_matrix(k->string()), SparseMatrix(), read_matrix(d->string()));
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST(k0.value == 8045.00001646865349, tolerance(1e-12));
  BOOST_TEST(k0.smallest.value() == 27.419997222627919, tolerance(1e-10));
  GeneralDamping general(s, k0, classify_damping(s), 1.5, true);
  BOOST_TEST(general.growth().value() == 0);
  for (const auto& [method, h] : {std::pair{"explicit-euler", 0.0011149461183252914},
                                  {"rk2", 0.00891935463676813},
                                  {"rk4", 0.0324414616286668}})
    BOOST_TEST(general.limits(method).h_max.value() == h, tolerance(1e-9));
}

// One damper on a shaft with massless unknowns: no more is certified than eigenvalues allow.
BOOST_AUTO_TEST_CASE(the_shaft_is_certified_below_its_limit, *boost::unit_test::label("slow")) {
  const auto k = shared_data("matrices/nlevp_shaft_K.mtx"), m = shared_data("matrices/nlevp_shaft_M.mtx"),
             c = shared_data("matrices/nlevp_shaft_C.mtx");
  if (!k || !m || !c) return;
  const StructuralMatrices s =
      prepare(read_matrix(k->string()), read_matrix(m->string()), read_matrix(c->string()));
  const StiffestMode k0 = stiffest_mode(s);
  BOOST_TEST(k0.value == 14833231231829.38229459, tolerance(1e-9));
  GeneralDamping general(s, k0, classify_damping(s), 1.5, true);
  const MethodLimits rk4 = general.limits("rk4"), symplectic = general.limits("symplectic-euler");
  BOOST_TEST(rk4.h_max.value() <= std::sqrt(8 / k0.value) * (1 + 1e-6));  // one damper among stiff springs
  BOOST_TEST(rk4.h_certified.value() <= rk4.h_max.value());
  BOOST_TEST(rk4.h_certified.value() >= 0.99 * rk4.h_max.value());
  BOOST_TEST(symplectic.h_certified.value() <= symplectic.h_max.value());
  BOOST_TEST(symplectic.h_max.value() <= 2 / std::sqrt(k0.value) * (1 + 1e-9));
}

// Symplectic Euler's own matrix decides. Undamped, modes are those of K' alone, and 2/√2 is the limit of
// [[2, 1], [0, 1]]. The benchmark bicycle steers and leans as it rolls. A rotor on bearings, undamped, is
// stable, and unstable at every step of this method: |λ| is 1 + 1.8e-8 at h = 1e-7.
BOOST_AUTO_TEST_CASE(symplectic_eulers_own_matrix_decides_without_symmetry) {
  using Dense = Eigen::MatrixXd;
  const auto limits = [](const Dense& k, const Dense& m, const Dense& d) {
    const StructuralMatrices s =
        prepare_nonsymmetric(k.sparseView(0.0, 0.0), m.sparseView(0.0, 0.0), d.sparseView(0.0, 0.0));
    return GeneralDamping(s, stiffest_mode(s), classify_damping(s), 1.5, true).limits("symplectic-euler");
  };
  const Dense one = Dense::Identity(2, 2), none = Dense::Zero(2, 2);
  const MethodLimits triangle = limits(Dense{{2, 1}, {0, 1}}, one, none);
  BOOST_TEST(triangle.h_max.value() == std::sqrt(2), tolerance(1e-9));
  BOOST_TEST(triangle.recommended.value() == std::sqrt(2 / 1.5), tolerance(1e-9));
  BOOST_TEST((triangle.source == LimitSource::estimate && !triangle.h_certified));
  const MethodLimits bicycle =
      limits(Dense{{-794.1195, 1889.423905}, {-25.501095, 58.48007}},
             Dense{{80.812, 2.3194}, {2.3194, 0.29784}}, Dense{{0, 169.33}, {-4.25175, 8.427}});
  BOOST_TEST(bicycle.h_max.value() == 0.24078, tolerance(2e-5));
  const Dense block{{1e6, 5e4}, {5e4, 5e4}};
  Dense k = Dense::Zero(4, 4), g = k;
  k.topLeftCorner(2, 2) = block;
  k.bottomRightCorner(2, 2) = Dense{{1e6, -5e4}, {-5e4, 5e4}};
  g(3, 1) = -380;
  g(1, 3) = 380;
  const MethodLimits rotor = limits(k, Eigen::Vector4d(10, 0.2, 10, 0.2).asDiagonal().toDenseMatrix(), g);
  BOOST_TEST((rotor.status == LimitStatus::none && !rotor.h_max && !rotor.recommended));
}

// Up to the limit no step is unstable, and beyond it the next is: of any K and D whose motion does not grow.
BOOST_AUTO_TEST_CASE(the_limit_without_symmetry_is_where_the_matrix_fails_first) {
  RandomNets random(41);
  int limited = 0;
  for (int i = 0; i < 60; ++i) BOOST_TEST_CONTEXT("system " << i) {
      const Eigen::Index n = 2 + i % 5;
      const auto entries = [&](double size) {
        Eigen::MatrixXd a(n, n);
        for (double& entry : a.reshaped()) entry = random.uniform(-size, size);
        return a;
      };
      const Eigen::MatrixXd a = entries(1), b = entries(1);
      const Eigen::MatrixXd k = a * a.transpose() + 0.2 * Eigen::MatrixXd::Identity(n, n) + entries(0.05),
                            d = 0.3 * b * b.transpose() + 0.2 * Eigen::MatrixXd::Identity(n, n) +
                                entries(0.1);
      const StructuralMatrices s =
          prepare_nonsymmetric(k.sparseView(0.0, 0.0), SparseMatrix(), d.sparseView(0.0, 0.0));
      GeneralDamping general(s, stiffest_mode(s), classify_damping(s), 1.5, true);
      if (general.growth().value() > 0) continue;
      const MethodLimits limits = general.limits("symplectic-euler");
      BOOST_REQUIRE((limits.status == LimitStatus::limited));
      ++limited;
      const double h = *limits.h_max;
      for (int j = 1; j <= 40; ++j)
        BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", h * j / 40.0001)) <= 1 + 1e-9);
      BOOST_TEST(largest_modulus(transition_matrix(s, "symplectic-euler", h * (1 + 1e-6))) > 1);
      BOOST_TEST(*limits.recommended < h);
    }
  BOOST_TEST(limited > 40);
}

// What decays counts, what grows does not, whatever the damping is called: the same K, indefinite, with
// d0 M + alpha K, and with a trace of other damping beside it.
BOOST_AUTO_TEST_CASE(an_unstable_structure_has_one_limit_whatever_its_damping_is_called) {
  const Eigen::MatrixXd turn =
      Eigen::HouseholderQR<Eigen::MatrixXd>(Eigen::MatrixXd{{1, 2, -1}, {0.5, -1, 3}, {2, 0.3, 1}})
          .householderQ();
  Eigen::MatrixXd trace = Eigen::MatrixXd::Zero(3, 3);
  trace(0, 0) = 1e-9;
  for (const double lowest : {-0.3, -60.0})
    for (const double alpha : {0.0, 0.02}) {
      const Eigen::MatrixXd k = turn * Eigen::Vector3d(9, 2, lowest).asDiagonal() * turn.transpose(),
                            symmetric = (k + k.transpose()) / 2,
                            d = 0.3 * Eigen::MatrixXd::Identity(3, 3) + alpha * symmetric;
      const auto prepared = [&](const Eigen::MatrixXd& damping) {
        return prepare(symmetric.sparseView(0.0, 0.0), SparseMatrix(), damping.sparseView(0.0, 0.0));
      };
      StructureLimits rayleigh(structure_of(prepared(d))), general(structure_of(prepared(d + trace)));
      BOOST_TEST((rayleigh.structure().damping.kind == DampingModel::Kind::rayleigh));
      BOOST_TEST((general.structure().damping.kind == DampingModel::Kind::general));
      BOOST_TEST(rayleigh.growth().value() == general.growth().value(), tolerance(1e-7));
      for (const Method& method : all_methods())
        BOOST_TEST_CONTEXT(method.name() << ", lowest " << lowest << ", alpha " << alpha) {
          const MethodLimits &one = rayleigh.limits(method), &other = general.limits(method);
          BOOST_TEST((one.status == other.status));
          if (one.status == LimitStatus::limited) {
            // the line of modes holds more than these three
            BOOST_TEST(*one.h_max <= *other.h_max * (1 + 1e-6));
            if (lowest < -1) BOOST_TEST(*one.h_max >= *other.h_max * (1 - 1e-6));
          }
        }
    }
}

// Negative damping: K = diag(4, 1), D = diag(-0.1, 0.1). The stiff motion grows by itself, and turns over at
// Y = 4 + 2|X|; the other one leaves at 2hd + h²k = 4. Where all motions grow nothing limits the step.
BOOST_AUTO_TEST_CASE(symplectic_euler_has_a_limit_with_negative_damping) {
  const auto limits = [](const Eigen::Vector2d& k, const Eigen::Vector2d& d) {
    const StructuralMatrices s =
        prepare(SparseMatrix(k.asDiagonal()), SparseMatrix(), SparseMatrix(d.asDiagonal()));
    return StructureLimits(structure_of(s)).limits("symplectic-euler");
  };
  const MethodLimits mixed = limits({4, 1}, {-0.1, 0.1});
  BOOST_TEST(mixed.h_max.value() == -0.1 + std::sqrt(4.01), tolerance(1e-9));
  // Growth at the structure's own pace asks for its mirror image's step: 2h|d| + h²k < 4 of the stiff motion.
  BOOST_TEST(mixed.recommended.value() <= (-0.1 + std::sqrt(16.01)) / 4);
  for (const Eigen::Vector2d& d : {Eigen::Vector2d(-0.4, -0.1), Eigen::Vector2d(-0.1, -0.1)})
    BOOST_TEST((limits({4, 1}, d).status == LimitStatus::unlimited));
}

// Masses over ten decades: the real parts of slow motions are rounding beside the fast ones, and decide for
// explicit Euler and RK2. Long doubles know them.
BOOST_AUTO_TEST_CASE(real_parts_are_known_to_their_own_scale) {
  RandomNets random(43);
  for (int i = 0; i < 40; ++i) BOOST_TEST_CONTEXT("system " << i) {
      const Eigen::Index n = 3 + i % 6;
      Eigen::VectorXd mass(n);
      for (double& m : mass) m = random.log_uniform(-5, 5);
      mass[0] = 1e-5;
      mass[n - 1] = 1e5;
      const auto definite = [&](double size) {
        Eigen::MatrixXd a(n, n);
        for (double& entry : a.reshaped()) entry = random.uniform(-1, 1);
        const Eigen::MatrixXd b = size * (a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n));
        return Eigen::MatrixXd((b + b.transpose()) / 2);
      };
      const Eigen::MatrixXd k = definite(100), d = definite(random.log_uniform(-4, -1));
      const StructuralMatrices s =
          prepare(k.sparseView(0.0, 0.0), SparseMatrix(mass.asDiagonal()), d.sparseView(0.0, 0.0));
      long double rate = 0;
      double expected = infinity;
      for (const std::complex<long double> mu : long_eigenvalues(s, rate))
        expected = std::min(expected, static_cast<double>(-2 * mu.real() / std::norm(mu) / rate));
      const auto modes = generator_spectrum(s).value();
      BOOST_TEST(modes.size() == static_cast<std::size_t>(2 * n));
      BOOST_TEST(critical_step("explicit-euler", modes).value() == expected, tolerance(1e-6));
      BOOST_TEST(critical_step("rk2", modes).has_value());
    }
}

// A free chain of a grain and two ships: the slow motion has 1e-7 of the fast one's rate and is no rigid one,
// and half of its damping is 1e-9 of that again. A mode k has the real part -alpha k / 2.
BOOST_AUTO_TEST_CASE(slow_motions_are_told_from_rigid_ones) {
  const Eigen::MatrixXd k{{1, -1, 0}, {-1, 2, -1}, {0, -1, 1}};
  const Eigen::Vector3d mass(1e-7, 1e7, 3e7);
  constexpr double alpha = 1e-5;
  const StructuralMatrices s = prepare(k.sparseView(0.0, 0.0), SparseMatrix(mass.asDiagonal()),
                                       SparseMatrix(alpha * k.sparseView(0.0, 0.0)));
  const auto modes = generator_spectrum(s).value();
  BOOST_TEST(modes.size() == 4U);
  for (const double stiffness :
       {1 / 1e7 + 1 / 3e7, 1e7}) {  // to 1e-14: the grain weighs nothing beside ships
    const double real = -alpha * stiffness / 2;
    BOOST_TEST(std::count_if(modes.begin(), modes.end(), [&](std::complex<double> mu) {
                 return std::abs(mu.real() - real) < -1e-9 * real &&
                        std::abs(std::norm(mu) - stiffness) < 1e-9 * stiffness;
               }) == 2);
  }
}

BOOST_AUTO_TEST_CASE(nothing_is_certified_of_structures_that_may_grow_by_themselves) {
  RandomNets random(6);
  const StructuralMatrices s = matrices(random.net(true));
  StiffestMode k0 = stiffest_mode(s);
  DampingModel general{DampingModel::Kind::general, 0, 0, false};
  const auto has_no_proof = [&](std::string_view method, std::string_view reason) {
    const MethodLimits limits = GeneralDamping(s, k0, general, 1.5, true).limits(method);
    BOOST_TEST((!limits.h_max || limits.source == LimitSource::estimate));
    BOOST_TEST(!limits.h_certified);
    BOOST_TEST(limits.unproved == reason);
  };
  for (const Method& method : all_methods()) {
    has_no_proof(method.name(), "D is indefinite");
    k0.indefinite = true;
    general.semidefinite = true;
    has_no_proof(method.name(), "K is indefinite");
    k0.indefinite = false;
    general.semidefinite = false;
  }
}

BOOST_AUTO_TEST_SUITE_END()
