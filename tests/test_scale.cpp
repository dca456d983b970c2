// Many unknowns: proofs at their edge by blocks and by pieces, and k0 to few digits.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <random>

#include "analysis/constants.h"
#include "analysis/proofs/definiteness.h"
#include "analysis/proofs/sum_of_couplings.h"
#include "analysis/spectra/lanczos.h"
#include "analysis/spectra/rigid_motions.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/structure_limits.h"
#include "solvers/linear/block_sparse_matrix.h"
#include "solvers/team.h"
#include "tests/instruments.h"
#ifdef SPRINGSTAB_CHOLMOD
#include "analysis/proofs/pieces.h"
#endif

#ifdef SPRINGSTAB_CHOLMOD
extern "C" char* openblas_get_corename();
#endif

BOOST_AUTO_TEST_SUITE(scale)

using namespace springstab;

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

// N x N masses with springs of stiffness k between neighbours and to a fixed rim.
SparseMatrix membrane(int n, double k = 1) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto couple = [&](int i, int j) {
    entries.emplace_back(i, j, -k);
    entries.emplace_back(j, i, -k);
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      entries.emplace_back(i * n + j, i * n + j, 4 * k);
      if (i + 1 < n) couple(i * n + j, (i + 1) * n + j);
      if (j + 1 < n) couple(i * n + j, i * n + j + 1);
    }
  SparseMatrix a(n * n, n * n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

// 4 sin²(jπ/(2(n+1))) of fixed-fixed chains, added up.
double membrane_k0(int n) {
  const double s = std::sin(n * std::numbers::pi / (2 * (n + 1)));
  return 8 * s * s;
}

double membrane_k_min(int n) {
  const double s = std::sin(std::numbers::pi / (2 * (n + 1)));
  return 8 * s * s;
}

SparseMatrix shifted(const SparseMatrix& a, double sigma) {
  SparseMatrix unit(a.rows(), a.cols());
  unit.setIdentity();
  return sigma * unit - a;
}

// Just below and just above what is factorized by blocks.
std::vector<int> around_the_crossover() {
  const int root = static_cast<int>(std::sqrt(static_cast<double>(many_unknowns)));
  return {root, root + 1, root + 2, root + 3};
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_proof_holds_down_to_its_resolution_and_never_below_the_truth) {
  for (const int n : around_the_crossover()) BOOST_TEST_CONTEXT(n << " x " << n) {
      const double k0 = membrane_k0(n);
      for (const double scale : {1.0, 1e-200, 1e200}) {
        DefinitenessProof proof(prepare(membrane(n, scale)));
        for (const double below : {0.0, eps, 1e-14, 1e-12, 1e-9, 1e-3, 0.5})
          BOOST_TEST(!proof.holds(scale * k0 * (1 - below), 0, 1), "below by " << below << ", " << scale);
        for (const double above : {1e-8, 1e-6, 1e-2, 1.0})
          BOOST_TEST(proof.holds(scale * k0 * (1 + above), 0, 1), "above by " << above << ", " << scale);
        for (const double sigma : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
          BOOST_TEST(!proof.holds(sigma, 0, 1));
      }
    }
}

#if defined(SPRINGSTAB_CHOLMOD) && defined(__x86_64__)
BOOST_AUTO_TEST_CASE(openblas_has_no_kernels_of_older_processors) {
  const bool newer = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (newer && !std::getenv("OPENBLAS_CORETYPE"))
    BOOST_TEST(openblas_get_corename() != std::string("Prescott"));
  BOOST_TEST(openblas_get_corename() != std::string("Unknown"));
}
#endif

// Its smallest eigenvalue is what stiffness has left: -1e-13 of the largest is not positive.
BOOST_AUTO_TEST_CASE(a_matrix_just_indefinite_is_never_called_positive_definite) {
  for (const int n : around_the_crossover()) {
    const SparseMatrix a = membrane(n);
    const double k_min = membrane_k_min(n);
    for (const double part : {1.0, 1 + 1e-13, 1 + 1e-9, 1 + 1e-6, 2.0}) {
      DefinitenessProof proof(prepare(shifted(SparseMatrix(-a), -part * k_min)));  // A - part k_min
      BOOST_TEST(!proof.holds(0, 0, -1), n << ": " << part);
    }
    DefinitenessProof proof(prepare(shifted(SparseMatrix(-a), -(1 - 1e-3) * k_min)));
    BOOST_TEST(proof.holds(0, 0, -1));
  }
}

BOOST_AUTO_TEST_CASE(the_shift_covers_what_rounding_could_do) {
  for (const int n : around_the_crossover()) {
    const SparseMatrix a = membrane(n);
    SparseCholesky cholesky;
    BOOST_TEST(cholesky.analyze(a));
    BOOST_TEST(cholesky.error() >= unit_roundoff * cholesky.entries());
    BOOST_TEST(cholesky.entries() >= static_cast<double>(a.rows() + a.nonZeros()) / 2);
    BOOST_TEST(cholesky.error() < 1e-8);
    BOOST_TEST(cholesky.factorize(a));
  }
}

BOOST_AUTO_TEST_CASE(what_is_not_finite_has_no_factorization) {
  for (const int n : around_the_crossover()) {
    const SparseMatrix good = membrane(n);
    SparseCholesky cholesky;
    BOOST_TEST(cholesky.factorize(good));
    const Eigen::Index middle = good.rows() / 2 + 1;
    for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity(), -4.0, 0.0}) {
      SparseMatrix bad = good;
      bad.coeffRef(middle, middle) = wrong;
      BOOST_TEST(!cholesky.factorize(bad), n << ": " << wrong);
    }
    SparseMatrix overflows = good;  // a tiny pivot: its column of L is infinite
    overflows.coeffRef(middle, middle) = 1e-300;
    overflows.coeffRef(middle, middle - 1) = overflows.coeffRef(middle - 1, middle) = 1e300;
    BOOST_TEST(!cholesky.factorize(overflows));
    BOOST_TEST(cholesky.factorize(good));  // and goes on as before
  }
}

// A flat net: what it resists sideways is rounding. Above the crossover a factorization by blocks tells.
BOOST_AUTO_TEST_CASE(motions_that_rounding_alone_resists_are_held_at_any_size) {
  for (const int n : {99, 100, 101, 102}) {
    const SparseMatrix net = membrane(n);
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index j = 0; j < net.cols(); ++j) {
      for (SparseMatrix::InnerIterator it(net, j); it; ++it)
        entries.emplace_back(2 * it.row(), 2 * j, it.value());
      if (j % 3 != 0) entries.emplace_back(2 * j + 1, 2 * j + 1, (j % 3 == 1 ? 1 : -1) * eps);
    }
    SparseMatrix flat(2 * net.rows(), 2 * net.cols());
    flat.setFromTriplets(entries.begin(), entries.end());
    const StructuralMatrices rest = without_rigid_motions(prepare(flat));
    BOOST_TEST(rest.size() == net.rows(), n);
    BOOST_TEST((rest.stiffness - net).norm() == 0);
  }
}

// The same net with free edges: translations are rigid, which is seen at once.
BOOST_AUTO_TEST_CASE(free_unknowns_are_held_without_a_search_but_translations_are_noticed) {
  const int n = 150;
  const SparseMatrix net = membrane(n);
  std::vector<Eigen::Triplet<double>> entries, free;
  for (Eigen::Index j = 0; j < net.cols(); ++j)
    for (SparseMatrix::InnerIterator it(net, j); it; ++it) {
      const double own = static_cast<double>(net.col(j).nonZeros() - 1);
      entries.emplace_back(3 * it.row(), 3 * j, it.value());
      free.emplace_back(3 * it.row(), 3 * j, it.row() == j ? own : it.value());
    }
  SparseMatrix flat(3 * net.rows(), 3 * net.cols()), loose = flat;
  flat.setFromTriplets(entries.begin(), entries.end());
  loose.setFromTriplets(free.begin(), free.end());
  const std::optional<StructuralMatrices> held = without_free_unknowns(prepare(flat));
  BOOST_REQUIRE(held.has_value());
  BOOST_TEST(held->size() == net.rows());
  BOOST_TEST((held->stiffness - net).norm() == 0);
  BOOST_TEST(!without_free_unknowns(prepare(loose)));
  BOOST_TEST(!without_free_unknowns(prepare(membrane(10))));  // few unknowns
}

// Springs along `axis`, each of stiffness k and k·across sideways, in a chain between two walls.
SparseMatrix chain_in_space(int n, const Eigen::Vector3d& axis, double across) {
  const Eigen::Matrix3d along = axis.normalized() * axis.normalized().transpose();
  const Eigen::Matrix3d b = along + across * (Eigen::Matrix3d::Identity() - along);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int i = 0; i < n; ++i) {
    a.block<3, 3>(3 * i, 3 * i) = 2 * b;
    if (i + 1 == n) break;
    a.block<3, 3>(3 * i, 3 * i + 3) = -b;
    a.block<3, 3>(3 * i + 3, 3 * i) = -b;
  }
  return a.sparseView();
}

// Its smallest eigenvalue is 4 sin²(π/(2(n+1))) across, and no less than 0 for all n if across >= 0.
BOOST_AUTO_TEST_CASE(a_sum_of_couplings_is_semidefinite_and_nothing_else_is_called_one) {
  const Eigen::Vector3d axis(1, 2, -0.7);
  const auto is_sum = [](SparseMatrix a, double shift) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) a.coeffRef(j, j) += shift * std::abs(a.coeff(j, j));
    a.makeCompressed();  // with the zeros that this has put in
    return is_sum_of_couplings(a);
  };
  for (const int n : {1, 2, 7, 40}) {
    for (const double across : {0.0, 1e-6, 0.5, 1.0})
      BOOST_TEST(is_sum(chain_in_space(n, axis, across), 1e-9));
    BOOST_TEST(is_sum(chain_in_space(n, Eigen::Vector3d::UnitY(), 0), 1e-9));
    for (const double across : {-1.0, -1e-3, -1e-8})
      BOOST_TEST(!is_sum(chain_in_space(n, axis, across), 1e-9));
    const SparseMatrix a = chain_in_space(n, axis, 1);
    if (n > 2) BOOST_TEST(!is_sum(a, -1e-9));  // between, nothing is left of the diagonal
  }
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int sums = 0, indefinite = 0;
  for (int trial = 0; trial < 2000; ++trial) {  // of a ring of four, with walls
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(12, 12);
    const double worst = trial % 2 == 0 ? 0 : 0.1 * normal(random);
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      const Eigen::Vector3d u(normal(random), normal(random), normal(random));
      const Eigen::Matrix3d b = u * u.transpose() + (i == 0 ? worst : 0) * Eigen::Matrix3d::Identity();
      a.block<3, 3>(3 * i, 3 * i) += b;
      a.block<3, 3>(3 * j, 3 * j) += b;
      a.block<3, 3>(3 * i, 3 * j) -= b;
      a.block<3, 3>(3 * j, 3 * i) -= b;
    }
    a.diagonal() *= 1 + 1e-9;
    using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Eigen::SelfAdjointEigenSolver<Exact> solver(a.cast<long double>(), Eigen::EigenvaluesOnly);
    const bool is_one = is_sum_of_couplings(a.sparseView());
    sums += is_one;
    indefinite += solver.eigenvalues()[0] < -1e-12;
    if (is_one) BOOST_TEST(solver.eigenvalues()[0] > -1e-13 * solver.eigenvalues()[11]);
    if (worst >= 0) BOOST_TEST(is_one);
  }
  BOOST_TEST(sums >= 1000);
  BOOST_TEST(indefinite > 100);
  BOOST_TEST(!is_sum_of_couplings(membrane(4)));  // not three unknowns a particle
  SparseMatrix wrong = chain_in_space(4, axis, 1);
  wrong.coeffRef(5, 5) = std::nan("");
  BOOST_TEST(!is_sum_of_couplings(wrong));
}

// Ten particles in a plane, springs between all neighbours and to a wall at each end.
struct Ladder {
  StructuralMatrices s;
  double least = infinity;  // damper / stiffness

  Ladder(std::mt19937_64& random, const std::vector<double>& dampers, double noise) {
    constexpr int count = 10;
    std::uniform_real_distribution<double> angle(0, std::numbers::pi), stiffness(1, 100);
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * count, 3 * count), d = k;
    std::size_t spring = 0;
    const auto couple = [&](int i, int j) {
      const double at = angle(random), ki = stiffness(random), di = dampers[spring++ % dampers.size()] * ki;
      const Eigen::Vector3d u(std::cos(at), 0, std::sin(at));
      Eigen::Matrix3d b = u * u.transpose();
      for (auto& [a, factor] : {std::pair{&k, ki}, {&d, di}}) {
        if (i >= 0) a->block<3, 3>(3 * i, 3 * i) += factor * b;
        a->block<3, 3>(3 * j, 3 * j) += factor * b;
        if (i >= 0) a->block<3, 3>(3 * i, 3 * j) -= factor * b;
        if (i >= 0) a->block<3, 3>(3 * j, 3 * i) -= factor * b;
      }
      least = std::min(least, di / ki);
    };
    couple(-1, 0);
    couple(-1, count - 1);
    for (const int reach : {1, 2})
      for (int i = 0; i + reach < count; ++i) couple(i, i + reach);
    for (int i = 0; i < count; ++i) k(3 * i + 1, 3 * i + 1) = (i % 2 == 0 ? 1 : -1) * noise;
    s = prepare(k.sparseView(0, 0), {}, d.sparseView(0, 0));
  }

  std::optional<double> ratio() const { return coupling_ratio(s, {0, s.size()}); }
};

BOOST_AUTO_TEST_CASE(no_coupling_has_a_damper_weaker_than_the_coupling_ratio) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> damper(0.01, 1);
  for (int trial = 0; trial < 200; ++trial) BOOST_TEST_CONTEXT(trial) {
      std::vector<double> dampers(trial % 20 + 1);
      for (double& c : dampers) c = damper(random);
      const Ladder ladder(random, dampers, trial % 2 == 0 ? 0 : 1e-14);
      const double ratio = ladder.ratio().value();
      BOOST_TEST(ratio == ladder.least, boost::test_tools::tolerance(1e-8));
      BOOST_TEST(ratio < ladder.least * (1 + 1e-10));
      using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
      const Exact d = Eigen::MatrixXd(ladder.s.damping).cast<long double>(),
                  rest = d - ratio * Eigen::MatrixXd(ladder.s.stiffness).cast<long double>();
      const Eigen::SelfAdjointEigenSolver<Exact> solver(rest, Eigen::EigenvaluesOnly);
      BOOST_TEST(solver.eigenvalues()[0] > -2e-11 * d.diagonal().maxCoeff());
      std::optional<double> least = infinity;
      for (const IndexRange part : {IndexRange{0, 6}, {6, 24}, {24, 24}, {24, 30}})
        least = std::min(*least, coupling_ratio(ladder.s, part).value());
      BOOST_TEST(*least == ratio, boost::test_tools::tolerance(1e-8));
    }
  BOOST_TEST(Ladder(random, {1, 1, 0}, 0).ratio().value() == 0);
  BOOST_TEST(!Ladder(random, {1, -1e-6}, 0).ratio());
  Ladder pushed(random, {1, -0.5},
                0);  // by couplings of which D - ρ K is semidefinite for large ρ, not for 0
  pushed.s.stiffness = SparseMatrix(1e3 * pushed.s.mass - pushed.s.stiffness);
  pushed.s.damping = SparseMatrix(1e3 * pushed.s.mass + pushed.s.damping);
  BOOST_TEST(!pushed.ratio());
  Ladder free(random, {1}, 0);
  free.s.stiffness.setZero();
  BOOST_TEST(std::isinf(free.ratio().value()));
  free.s.damping = SparseMatrix();
  BOOST_TEST(!free.ratio());
}

BOOST_AUTO_TEST_CASE(products_of_many_unknowns_are_the_same_bits_with_any_number_of_threads) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const LinearOperator op = symmetric_operator(membrane(201, 0.7));
  Eigen::VectorXd in(op.size), one, out;
  for (double& u : in) u = normal(random) * std::exp(5 * normal(random));
  op.apply(in, one);
  for (const int count : {2, 3, 5}) {
    set_loop_threads(count);
    op.apply(in, out);
    BOOST_TEST((out.array() == one.array()).all(), count);
  }
  set_loop_threads(1);
}

BOOST_AUTO_TEST_CASE(few_digits_of_k0_are_right_to_them_and_never_above) {
  for (const int n : {60, 142}) {
    const StructuralMatrices s = prepare(membrane(n));
    const LinearOperator op = scaled_stiffness(s);
    const double k0 = membrane_k0(n);
    for (const double tolerance : {1e-2, 1e-3, 5e-4, 1e-5}) BOOST_TEST_CONTEXT(n << ", " << tolerance) {
        const SymmetricEigenpairs found = largest_by_lanczos(op, {.tolerance = tolerance}, true);
        BOOST_REQUIRE(found.converged);
        const double value = found.values[0];
        BOOST_TEST(value <= k0 * (1 + 1e-13));
        BOOST_TEST(value >= k0 * (1 - tolerance / 2));
        Eigen::VectorXd image;
        op.apply(found.vectors.col(0), image);
        const double residual = (image - value * found.vectors.col(0)).norm();
        BOOST_TEST(residual <= 1.01 * tolerance * value);
        BOOST_TEST(residual >= 0.9 * found.residuals[0]);
        const SymmetricEigenpairs value_alone = largest_by_lanczos(op, {.tolerance = tolerance}, false);
        BOOST_TEST(value_alone.values[0] == value);
        BOOST_TEST(value_alone.products == found.products);
        const SymmetricEigenpairs in_little_memory =
            largest_by_lanczos(op, {.tolerance = tolerance}, true, 10 * op.size);
        BOOST_TEST(in_little_memory.products == 2 * found.products - 1);
        BOOST_TEST((in_little_memory.vectors == found.vectors));
      }
  }
  BOOST_CHECK_THROW(
      largest_by_lanczos(
          {4, [](const auto&, Eigen::VectorXd& out) { out = Eigen::VectorXd::Constant(4, std::nan("")); }},
          {.tolerance = 1e-3}, false),
      std::invalid_argument);
  const LinearOperator zero{4, [](const auto&, Eigen::VectorXd& out) { out = Eigen::VectorXd::Zero(4); }};
  const SymmetricEigenpairs nothing = largest_by_lanczos(zero, {.tolerance = 1e-3}, true);
  BOOST_TEST(nothing.converged);
  BOOST_TEST(nothing.values[0] == 0);
}

BOOST_AUTO_TEST_CASE(limits_by_both_searches_and_both_factorizations_agree) {
  for (const int n : around_the_crossover()) BOOST_TEST_CONTEXT(n << " x " << n) {
      const double h = 2 / std::sqrt(membrane_k0(n));
      for (const int digits : {3, 4, 6, 9}) {
        StructureLimits answer(structure_of(prepare(membrane(n))), {.digits = digits});
        BOOST_TEST(answer.digits().value() == digits);
        // Beside few digits a membrane's row sums, 8, may be the better bound.
        if (digits == 9) BOOST_TEST((answer.k0().bound_kind == BoundKind::inertia));
        BOOST_TEST(!answer.k0().indefinite);
        const MethodLimits& limits = answer.limits("symplectic-euler");
        const double error = std::pow(10, -digits);
        BOOST_TEST(limits.h_max.value() >= h * (1 - 1e-13));
        BOOST_TEST(limits.h_max.value() <= h * (1 + error));
        BOOST_TEST(limits.h_certified.value() < h);
        BOOST_TEST(limits.h_certified.value() >= h * (1 - 2.5 * error));  // half the residual
      }
      StructureLimits usual(structure_of(prepare(membrane(n))));
      BOOST_TEST(usual.digits().has_value() == (n * n >= many_unknowns));
    }
}

#ifdef SPRINGSTAB_CHOLMOD
// Stiffnesses that differ tenfold, and three unknowns a particle.
SparseMatrix uneven_net(int n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stiffness(1, 10);
  std::vector<Eigen::Triplet<double>> entries;
  const auto spring = [&](int i, int j, Eigen::Vector3d along) {
    const Eigen::Matrix3d k = stiffness(random) * along.normalized() * along.normalized().transpose();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        entries.emplace_back(3 * i + r, 3 * i + c, k(r, c));
        entries.emplace_back(3 * j + r, 3 * j + c, k(r, c));
        entries.emplace_back(3 * i + r, 3 * j + c, -k(r, c));
        entries.emplace_back(3 * j + r, 3 * i + c, -k(r, c));
      }
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if (i + 1 < n) spring(i * n + j, (i + 1) * n + j, {0.1, 0.2, 1});
      if (j + 1 < n) spring(i * n + j, i * n + j + 1, {1, -0.1, 0.2});
      if (i + 1 < n && j + 1 < n) spring(i * n + j, (i + 1) * n + j + 1, {1, 0.4, 1});
    }
  SparseMatrix a(3 * n * n, 3 * n * n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

BOOST_AUTO_TEST_CASE(pieces_prove_what_is_true_with_a_loss_that_overlap_makes_small) {
  const int n = test::times(200, 160);
  const double k0 = membrane_k0(n);
  const SparseMatrix even = membrane(n), uneven = uneven_net(100);
  const StiffestMode uneven_k0 = stiffest_mode(prepare(uneven), {.tolerance = 1e-8});
  BOOST_REQUIRE((uneven_k0.bound_kind == BoundKind::inertia));
  struct Case {
    const SparseMatrix& a;
    double k0, loss_of_8;  // of a bound with 8 layers
  };
  for (const Case& c : {Case{even, k0, 0.01}, {uneven, uneven_k0.value, 0.02}})
    for (const int layers : {4, 8, 16})
      BOOST_TEST_CONTEXT(c.a.rows() << " unknowns, " << layers << " layers") {
        const Pieces pieces(c.a, 2500, layers);
        BOOST_TEST(pieces.count() >= 4);
        for (const double below : {0.0, eps, 1e-12, 1e-6, 1e-2})
          BOOST_TEST(!pieces.prove(shifted(c.a, c.k0 * (1 - below))), "below by " << below);
        const double loss = c.loss_of_8 * 64 / (layers * layers);
        BOOST_TEST(pieces.prove(shifted(c.a, c.k0 * (1 + loss))));
      }
  BOOST_TEST(!Pieces(even, 2500, 4).prove(SparseMatrix(-even)));
  SparseMatrix bad = shifted(even, 2 * k0);
  bad.coeffRef(5, 5) = std::nan("");
  BOOST_TEST(!Pieces(even, 2500, 4).prove(bad));
}

// The least σ that is proved, to the last of sixteen halvings.
BOOST_AUTO_TEST_CASE(pieces_prove_as_much_with_any_number_of_threads) {
  const int n = 151;  // not three unknowns a particle
  const SparseMatrix a = membrane(n);
  const Pieces pieces(a, 2500, 6);
  BOOST_TEST(pieces.count() >= 5);
  const auto least_loss = [&] {
    double failed = 0, proved = 0.1;
    for (int halving = 0; halving < test::times(16, 4); ++halving) {
      const double middle = (failed + proved) / 2;
      (pieces.prove(shifted(a, membrane_k0(n) * (1 + middle))) ? proved : failed) = middle;
    }
    return proved;
  };
  const double one = least_loss();
  BOOST_TEST(one > 1e-4);
  BOOST_TEST(one < 0.05);
  for (const int count : {2, 3}) {
    set_loop_threads(count);
    BOOST_TEST(least_loss() == one, count);
  }
  set_loop_threads(1);
}

BOOST_AUTO_TEST_CASE(one_piece_loses_nothing) {
  const SparseMatrix a = membrane(50);
  const Pieces one(a, 2500, 8);
  BOOST_TEST(one.count() == 1);
  BOOST_TEST(one.prove(shifted(a, membrane_k0(50) * (1 + 1e-9))));
  BOOST_TEST(!one.prove(shifted(a, membrane_k0(50))));
}

// Each of the membrane's unknowns as `many` that are coupled to each other and to the neighbours', by full
// blocks or axis by axis.
SparseMatrix of_particles(const SparseMatrix& a, int many, bool full) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      for (int p = 0; p < many; ++p)
        for (int q = 0; q < many; ++q)
          if (full || p == q || it.row() == j)
            entries.emplace_back(many * it.row() + p, many * j + q, it.value());
  SparseMatrix all(many * a.rows(), many * a.cols());
  all.setFromTriplets(entries.begin(), entries.end());
  return all;
}

// 24 x 24 particles: any number of unknowns up to three divides that of all.
BOOST_AUTO_TEST_CASE(the_unknowns_of_a_particle_are_one_node) {
  for (const int many : {2, 3})
    BOOST_TEST(graph_of(of_particles(membrane(24), many, true)).unknowns_a_node == many);
  BOOST_TEST(graph_of(of_particles(membrane(24), 3, false)).unknowns_a_node == 3);
}

// Every third unknown coupled to nothing: all of them are eliminated once, those first.
BOOST_AUTO_TEST_CASE(what_is_coupled_to_nothing_is_eliminated_first) {
  const SparseMatrix a = of_particles(membrane(24), 2, true);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < a.cols(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      entries.emplace_back(it.row() / 2 * 3 + it.row() % 2, j / 2 * 3 + j % 2, it.value());
  const int n = 3 * 24 * 24;
  for (int i = 2; i < n; i += 3) entries.emplace_back(i, i, 1);
  SparseMatrix with_more(n, n);
  with_more.setFromTriplets(entries.begin(), entries.end());
  std::vector<long> order = dissection_order(with_more);
  BOOST_REQUIRE(std::ssize(order) == n);
  for (int i = 0; i < n / 3; ++i) BOOST_TEST(order[i] == 3 * i + 2);
  std::sort(order.begin(), order.end());
  for (int i = 0; i < n; ++i) BOOST_TEST(order[i] == i);
}

// Two ranks with a half of the membrane each, which see no farther than they must: their verdicts together
// are that of the same pieces of the whole.
BOOST_AUTO_TEST_CASE(pieces_of_parts_that_see_their_neighbours_are_those_of_the_whole) {
  const int n = 80, layers = 2, half = n * n / 2 + 13;
  const SparseMatrix a = membrane(n);
  const Graph graph = graph_of(a, 1);
  std::vector<int> part(static_cast<std::size_t>(n * n));  // two of each half
  for (int i = 0; i < n * n; ++i) part[i] = 2 * (i >= half) + (i % n > n / 3);
  const Pieces whole(graph, part, 4, layers);
  BOOST_TEST(whole.count() == 4);
  const int seen = n * (2 * layers + 1);  // a row of the membrane an edge
  const auto half_proves = [&](bool lower, const SparseMatrix& q) {
    const int first = lower ? 0 : half - seen, last = lower ? half + seen : n * n;
    const SparseMatrix around = q.middleRows(first, last - first).middleCols(first, last - first);
    std::vector<int> name;  // own ones first
    for (int i = first; i < last; ++i) name.push_back(lower ? part[i] : (part[i] + 2) % 4);
    const Pieces own(graph_of(around, 1), name, 2, layers);
    BOOST_TEST(own.count() == 2);
    return own.prove(around);
  };
  const double k0 = membrane_k0(n);
  int proved = 0, refused = 0;
  for (double above = -3e-4; above < 3e-3; above += 1e-4) {
    const SparseMatrix q = shifted(a, k0 * (1 + above));
    const bool all = whole.prove(q);
    BOOST_TEST((half_proves(true, q) && half_proves(false, q)) == all, above);
    ++(all ? proved : refused);
    if (above <= 0) BOOST_TEST(!all, above);
  }
  BOOST_TEST(proved > 3);
  BOOST_TEST(refused > 6);  // also what is true, but too near
}

// A chain, an N x N membrane or an N x N x N block with springs between neighbours.
Graph lattice(int n, int dimensions) {
  Graph graph;
  int nodes = 1;
  for (int d = 0; d < dimensions; ++d) nodes *= n;
  for (int i = 0; i < nodes; ++i) {
    for (int d = 0, stride = 1; d < dimensions; ++d, stride *= n)
      for (const int step : {-1, 1})
        if (const int at = i / stride % n + step; at >= 0 && at < n)
          graph.neighbour.push_back(i + step * stride);
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

// A ball of radius r has 2r + 1 nodes of a chain, and (2r + 1)(2r² + 2r + 3)/3 of a block.
BOOST_AUTO_TEST_CASE(balls_of_a_lattice_grow_as_its_dimension_says) {
  const std::vector<long> chain = largest_balls(lattice(5000, 1), 300, 4),
                          block = largest_balls(lattice(41, 3), 1000, 2);
  BOOST_TEST(chain.size() == 150 + 4 + 1);
  for (long r = 0; r < std::ssize(chain); ++r) BOOST_TEST(chain[r] == 2 * r + 1);
  BOOST_TEST(block.size() >= 9 + 2 + 1);  // from near a face it takes more
  for (long r = 0; r < std::ssize(block); ++r)
    BOOST_TEST(block[r] <= (2 * r + 1) * (2 * r * r + 2 * r + 3) / 3);
  for (long r = 0; r < 8; ++r) BOOST_TEST(block[r] > 3 * r * r);
  BOOST_TEST(largest_balls(lattice(20, 1), 300, 4).back() == 20);
}

BOOST_AUTO_TEST_CASE(pieces_of_solids_are_smaller_than_those_of_nets) {
  const Graph net = lattice(400, 2), solid = lattice(54, 3);
  BOOST_TEST(Pieces::cheapest_particles(net, 11) == Pieces::usual_particles);
  const int few = Pieces::cheapest_particles(solid, 3);
  BOOST_TEST(few < Pieces::usual_particles);
  BOOST_TEST(few > 63);  // a ball of as many layers as overlap: what is around it is 6 times that
}

// Of matrices of which nothing is kept but K and M: as much is proved as of the matrix that they make.
BOOST_AUTO_TEST_CASE(a_proof_by_pieces_of_columns_formed_in_turn_is_that_of_the_matrix) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> weight(0.5, 2);
  StructuralMatrices s;
  s.stiffness = uneven_net(40);
  Eigen::VectorXd mass(s.size());
  for (double& m : mass) m = weight(random);
  s.mass = SparseMatrix(mass.asDiagonal());
  const SparseMatrix unit = scaled(s.stiffness, mass.cwiseSqrt().cwiseInverse());
  const auto pieces = std::make_shared<const Pieces>(s.stiffness, 300, 4);
  BOOST_TEST(pieces->count() >= 5);
  const double k0 = stiffest_mode(s, {.tolerance = 1e-8}).value;
  DefinitenessProof formed(s, pieces, [](bool mine) { return mine; });
  int proved = 0, refused = 0;
  for (double above = 0; above < 0.1; above += 0.004) {
    const bool of_matrix = pieces->prove(shifted(unit, k0 * (1 + above)));
    BOOST_TEST(formed.holds(k0 * (1 + above), 0, 1) == of_matrix, above);
    BOOST_TEST(formed.holds(2 * k0 * (1 + above), 0, 2) == of_matrix, above);
    ++(of_matrix ? proved : refused);
  }
  BOOST_TEST(proved > 3);
  BOOST_TEST(refused > 1);
}

// Of M and D with entries where K has none.
BOOST_AUTO_TEST_CASE(a_proof_takes_matrices_of_different_patterns) {
  const int n = 12;
  StructuralMatrices s;
  s.stiffness = membrane(n);
  s.mass = SparseMatrix(0.01 * membrane(n) * membrane(n));  // neighbours of neighbours, too
  SparseMatrix unit(n * n, n * n);
  unit.setIdentity();
  s.mass += unit;
  s.damping = SparseMatrix(membrane(n) * membrane(n));
  const double k = membrane_k0(n), m = 1 + 0.01 * k * k;  // all have the membrane's modes
  for (const auto& [a, b] : {std::pair{0.3, 0.0}, {0.0, 0.2}, {0.3, 0.2}}) {
    const double least =
        (a * k * k + b * k) / m;  // c of the stiffest mode, and as more k makes more of it, of all
    DefinitenessProof proof(s);
    BOOST_TEST(proof.holds(least * (1 + 1e-9), a, b));
    BOOST_TEST(!proof.holds(least * (1 - 1e-9), a, b));
  }
}
// diag(d) A diag(d) as blocks and as single numbers.
BOOST_AUTO_TEST_CASE(blocks_are_scaled_as_numbers_are) {
  const SparseMatrix a = uneven_net(7);
  std::optional<BlockSparseMatrix> blocks = in_blocks(a);
  BOOST_REQUIRE(blocks.has_value());
  const auto lower = [](const SparseMatrix& m) -> Eigen::MatrixXd {  // of which a block matrix consists
    return Eigen::MatrixXd(m).triangularView<Eigen::Lower>();
  };
  BOOST_TEST((lower(blocks->to_sparse()) == lower(a)));
  Eigen::VectorXd d(a.rows());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = 1 + 0.37 * static_cast<double>(i % 11);
  blocks->scale(d);
  const SparseMatrix sparse = blocks->to_sparse(), expected = scaled(a, d);
  BOOST_TEST(sparse.isCompressed());
  BOOST_TEST(sparse.nonZeros() == expected.nonZeros());
  BOOST_TEST((lower(sparse) == lower(expected)));
}

#endif

BOOST_AUTO_TEST_SUITE_END()
