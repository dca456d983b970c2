// The linear systems: their products and solves are those of the dense matrices that they stand for, and
// matrices that no structure has are refused by name.
#include <Eigen/SVD>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "analysis/method.h"
#include "analysis/spectra/generator_spectrum.h"
#include "solvers/linear/block_linear_system.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/linear/matrix_system.h"

BOOST_AUTO_TEST_SUITE(linear)

using namespace springstab;

namespace {

Shift implicit_euler(double h) { return {1, h, h * h}; }
const std::vector<Shift> some_shifts{
    implicit_euler(1e-3), implicit_euler(0.3), implicit_euler(20), {1.5, 0.2, 0.7}, {1, 0, 0.3}};

using Dense = Eigen::MatrixXd;
using IndexPair = std::pair<int, int>;

constexpr double eps = std::numeric_limits<double>::epsilon();
const double nan_value = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  int index(int size) { return std::uniform_int_distribution(0, size - 1)(engine_); }
  Vector vector(Eigen::Index size) {
    Vector v(size);
    for (double& entry : v) entry = (*this)(-1, 1);
    return v;
  }
  Dense matrix(Eigen::Index rows, Eigen::Index columns) {
    Dense a(rows, columns);
    for (double& entry : a.reshaped()) entry = (*this)(-1, 1);
    return a;
  }
  /// Symmetric positive definite, with a condition number of some hundreds.
  Dense definite(Eigen::Index size) {
    const Dense a = matrix(size, size);
    return a * a.transpose() + 0.1 * Dense::Identity(size, size);
  }

 private:
  std::mt19937_64 engine_;
};

/// Pairs that repeat themselves, the other way round too, and couple a row with itself: rows no farther apart
/// than five, where there are more than 20.
std::vector<IndexPair> random_couplings(int rows, int count, Random& random) {
  const int reach = rows > 20 ? 5 : rows;
  std::vector<IndexPair> pairs;
  for (int k = 0; k < count; ++k) {
    const int i = random.index(rows), j = std::max(0, i - random.index(reach));
    pairs.emplace_back(i, j);
    if (k % 3 == 0) pairs.emplace_back(j, i);
    if (k % 4 == 0) pairs.emplace_back(i, i);
  }
  return pairs;
}

void check_equal(const Vector& found, const Vector& expected, double tolerance) {
  BOOST_REQUIRE_EQUAL(found.size(), expected.size());
  BOOST_TEST((found - expected).norm() <= tolerance * expected.norm(),
             "relative difference " << (found - expected).norm() / expected.norm());
  BOOST_TEST(expected.norm() > 0);
}

/// Fills a symmetric matrix that is positive definite by the dominance of its diagonal blocks.
void fill_definite(BlockSparseMatrix& a, double size, Random& random) {
  for (int i = 0; i < a.rows(); ++i) {
    const Dense own = random.definite(3);
    for (int r = 0; r < 9; ++r) a.block(a.diagonal(i))[r] += size * own(r / 3, r % 3);
  }
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < i; ++j) {
      long lower = 0;
      try {
        lower = a.find(i, j);
      } catch (const std::out_of_range&) {
        continue;
      }
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) a.block(lower)[3 * r + c] = size * random(-0.5, 0.5);
        a.block(a.diagonal(i))[4 * r] += 1.5 * size;
        a.block(a.diagonal(j))[4 * r] += 1.5 * size;
      }
    }
}

/// Masses over six powers of ten, and a stiffness as large beside them in the middle.
BlockLinearSystem random_system(int particles, RayleighDamping damping, bool own_damping, Random& random) {
  std::vector<double> mass;
  for (int i = 0; i < particles; ++i) mass.push_back(std::pow(10, random(-3, 3)));
  const auto stiffness =
      std::make_shared<BlockPattern>(particles, random_couplings(particles, 2 * particles, random));
  const auto own = std::make_shared<BlockPattern>(particles, random_couplings(particles, particles, random));
  BlockLinearSystem system = own_damping ? BlockLinearSystem(mass, damping, stiffness, own)
                                         : BlockLinearSystem(mass, damping, stiffness);
  fill_definite(system.stiffness(), 1, random);
  if (own_damping) fill_definite(*system.own_damping(), 0.3, random);
  return system;
}

/// K, M and D of a block system, dense.
struct DenseSystem {
  Dense k, m, d;

  explicit DenseSystem(BlockLinearSystem& s) : k(s.stiffness().to_sparse()) {
    m = lumped_mass(s.mass());
    d = s.damping().d0 * m + s.damping().alpha * k;
    if (s.own_damping()) d += Dense(s.own_damping()->to_sparse());
  }
  Dense shifted(const Shift& s) const { return s.mass * m + s.damping * d + s.stiffness * k; }
  Vector acceleration(const Vector& x, const Vector& v) const { return -m.llt().solve(k * x + d * v); }
};

const RayleighDamping dampings[] = {{0, 0}, {0.7, 0}, {0, 0.2}, {0.7, 0.2}};

/// Visits block systems without and with damping of each kind.
void for_each_system(const std::function<void(BlockLinearSystem&, Random&)>& visit) {
  for (const RayleighDamping& damping : dampings)
    for (const bool own : {false, true})
      for (const int particles : {1, 2, 9, 20, 40})
        BOOST_TEST_CONTEXT("d0 " << damping.d0 << ", alpha " << damping.alpha << ", own damping " << own
                                 << ", " << particles << " particles") {
          Random random(static_cast<std::uint64_t>(particles));
          BlockLinearSystem system = random_system(particles, damping, own, random);
          visit(system, random);
        }
}

/// A chain of particles between two walls: the block form of the second difference, times k.
BlockLinearSystem chain(int particles, double k) {
  std::vector<IndexPair> pairs;
  for (int i = 0; i + 1 < particles; ++i) pairs.emplace_back(i, i + 1);
  BlockLinearSystem system(std::vector<double>(particles, 1.0), {},
                           std::make_shared<BlockPattern>(particles, pairs));
  BlockSparseMatrix& a = system.stiffness();
  const double axis[3] = {0, 0, 0};
  for (int i = 0; i < particles; ++i) {
    add_isotropic_and_axial(a.block(a.diagonal(i)), 2 * k, 0, axis);
    if (i > 0) add_isotropic_and_axial(a.block(a.find(i, i - 1)), -k, 0, axis);
  }
  return system;
}

SparseMatrix sparse(const Dense& a) { return a.sparseView(0.0, 0.0); }

/// Checks that the action throws std::invalid_argument with those words, and says what was expected.
void expect_refused(const std::function<void()>& action, const std::string& words) {
  try {
    action();
    BOOST_ERROR("nothing was thrown, expected \"" + words + '"');
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    BOOST_TEST(what.find(words) != std::string::npos, what << " does not say " << words);
    BOOST_TEST(what.find("expected") != std::string::npos, what << " does not say what was expected");
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_block_matrix_is_the_dense_matrix_that_it_stands_for) {
  Random random(11);
  for (const int rows : {1, 2, 5, 17, 40})
    for (const int count : {0, rows, 4 * rows})
      BOOST_TEST_CONTEXT(rows << " rows, " << count << " couplings") {
        const auto couplings = random_couplings(rows, count, random);
        BlockSparseMatrix a(rows, couplings);
        std::set<IndexPair> pattern;
        for (int i = 0; i < rows; ++i) pattern.emplace(i, i);
        for (const auto& [i, j] : couplings) pattern.emplace(std::max(i, j), std::min(i, j));
        BOOST_TEST(a.rows() == rows);
        BOOST_TEST(a.blocks() == static_cast<long>(pattern.size()));

        Dense dense = Dense::Zero(3 * rows, 3 * rows);
        std::set<long> places;
        for (int i = 0; i < rows; ++i)
          for (int j = 0; j < rows; ++j) {
            if (!pattern.contains({i, j})) {
              BOOST_CHECK_THROW(a.find(i, j), std::out_of_range);
              continue;
            }
            const long where = a.find(i, j);
            places.insert(where);
            if (i == j) BOOST_TEST(where == a.diagonal(i));
            for (int r = 0; r < 9; ++r) a.block(where)[r] = random(-1, 1);
            Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(a.block(where));
            if (i == j) block = Dense(block + block.transpose());
            dense.block<3, 3>(3 * i, 3 * j) = block;
            dense.block<3, 3>(3 * j, 3 * i) = block.transpose();
          }
        BOOST_TEST(places.size() == pattern.size(), "two blocks share a place");
        BOOST_TEST((*places.begin() == 0 && *places.rbegin() == a.blocks() - 1));

        BOOST_TEST((Dense(a.to_sparse()) == dense));
        const std::optional<BlockSparseMatrix> again = in_blocks(a.to_sparse());
        BOOST_REQUIRE(again.has_value());
        BOOST_TEST((Dense(again->to_sparse()) == dense));
        BOOST_TEST(again->blocks() == a.blocks());
        const Vector in = random.vector(3 * rows);
        Vector out = Vector::Constant(3 * rows, nan_value);
        a.multiply(in.data(), out.data());
        // A sum of n products is off by at most n eps times the sum of their sizes.
        const Vector bound = 3 * rows * eps * (dense.cwiseAbs() * in.cwiseAbs());
        BOOST_TEST(((out - dense * in).array().abs() <= bound.array()).all());
        BOOST_TEST(out.norm() > 0);
        const Vector once = out;
        a.multiply(in.data(), out.data());
        BOOST_TEST((out == once));

        a.set_zero();
        BOOST_TEST(a.to_sparse().nonZeros() == 0);
        BOOST_TEST(a.blocks() == static_cast<long>(pattern.size()));
      }
}

BOOST_AUTO_TEST_CASE(a_matrix_is_left_as_it_is_where_blocks_would_be_larger) {
  const auto blocks = [](const Dense& a) { return in_blocks(a.sparseView()); };
  BOOST_TEST(blocks(Dense::Ones(6, 6)).has_value());
  BOOST_TEST(!blocks(Dense::Ones(7, 7)).has_value());      // no whole blocks
  BOOST_TEST(!blocks(Dense::Identity(6, 6)).has_value());  // 6 numbers of 12 bytes in two blocks of 76
}

BOOST_AUTO_TEST_CASE(a_block_outside_the_matrix_is_an_error) {
  for (const IndexPair& wrong : {IndexPair{-1, 0}, {0, -1}, {3, 0}, {0, 3}, {7, 7}}) {
    const IndexPair couplings[] = {{0, 1}, wrong};
    BOOST_CHECK_THROW(BlockSparseMatrix(3, couplings), std::invalid_argument);
    const BlockSparseMatrix a(3, {couplings, 1});
    BOOST_CHECK_THROW(a.find(wrong.first, wrong.second), std::out_of_range);
  }
  const IndexPair inside[] = {{2, 0}};
  BOOST_TEST(BlockSparseMatrix(3, inside).blocks() == 4);
}

BOOST_AUTO_TEST_CASE(products_of_a_block_system_are_the_dense_ones) {
  for_each_system([](BlockLinearSystem& system, Random& random) {
    const DenseSystem dense(system);
    const Vector x = random.vector(system.size()), v = random.vector(system.size());
    Vector out;
    system.acceleration(x, v, out);
    check_equal(out, dense.acceleration(x, v), 1e-13);
    system.stiffness_times(x, out);
    check_equal(out, dense.m.llt().solve(dense.k * x), 1e-13);
    system.damping_times(v, out);
    const Vector damped = dense.m.llt().solve(dense.d * v);
    if (damped.isZero(0)) {
      BOOST_TEST(out.isZero(0));
    } else {
      check_equal(out, damped, 1e-13);
    }
    BOOST_TEST(system.kinetic_energy(v) == 0.5 * v.dot(dense.m * v), boost::test_tools::tolerance(1e-13));
    BOOST_TEST(system.potential_energy(x) == 0.5 * x.dot(dense.k * x), boost::test_tools::tolerance(1e-13));
    Linearization<Vector> linear;
    system.linearize(x, v, linear);
    BOOST_TEST(linear.get() == &system);
  });
}

BOOST_AUTO_TEST_CASE(damping_can_be_changed_later) {
  Random random(5);
  BlockLinearSystem system = random_system(6, {}, true, random);
  system.set_damping({0.4, 0.9});
  const DenseSystem dense(system);
  const Vector v = random.vector(system.size());
  Vector out;
  system.damping_times(v, out);
  check_equal(out, dense.m.llt().solve(dense.d * v), 1e-13);
}

// The promise is on ‖b - Hy‖ in the norm of the inverse block diagonal; rounding adds eps times the
// condition.
BOOST_AUTO_TEST_CASE(a_block_system_solves_to_its_tolerance) {
  for_each_system([](BlockLinearSystem& system, Random& random) {
    const DenseSystem dense(system);
    const Vector rhs = random.vector(system.size());
    for (const Shift& shift : some_shifts) {
      const Dense shifted = dense.shifted(shift);
      Dense blocks = Dense::Zero(system.size(), system.size());
      for (Eigen::Index i = 0; i < system.size(); i += 3)
        blocks.block<3, 3>(i, i) = shifted.block<3, 3>(i, i);
      const auto norm = [&](const Vector& r) { return std::sqrt(r.dot(blocks.llt().solve(r))); };
      const Vector b = dense.m * rhs;
      for (const double tolerance : {1e-2, 1e-6, 1e-12})
        BOOST_TEST_CONTEXT("k " << shift.stiffness << ", " << tolerance) {
          system.solver = {.tolerance = tolerance, .preconditioner = Preconditioner::block_jacobi};
          Vector y;
          const SolveReport report = system.solve_shifted(shift, rhs, y);
          BOOST_TEST((report.status == StepStatus::done));
          BOOST_TEST(norm(b - shifted * y) <= (tolerance + 1e-13) * norm(b));
          BOOST_TEST(report.iterations >= 1);
          BOOST_TEST(report.products == report.iterations * (system.own_damping() ? 2 : 1));
          if (tolerance == 1e-12) check_equal(y, shifted.llt().solve(b), 1e-9);
        }
    }
  });
}

BOOST_AUTO_TEST_CASE(iterations_run_out_exactly_when_they_are_needed) {
  BlockLinearSystem system = chain(60, 1e4);  // h² k0 = 40 000 with h = 1
  system.solver.preconditioner = Preconditioner::block_jacobi;
  Random random(2);
  const Vector rhs = random.vector(system.size());
  Vector y;
  system.solver.tolerance = 1e-8;
  const long needed = system.solve_shifted(implicit_euler(1), rhs, y).iterations;
  BOOST_TEST(needed > 20);
  BOOST_TEST(needed <= 180);  // the number of unknowns
  system.solver.max_iterations = needed;
  BOOST_TEST((system.solve_shifted(implicit_euler(1), rhs, y).status == StepStatus::done));
  system.solver.max_iterations = needed - 1;
  const SolveReport report = system.solve_shifted(implicit_euler(1), rhs, y);
  BOOST_TEST((report.status == StepStatus::not_converged));
  BOOST_TEST(report.iterations == needed - 1);
}

// The block-Jacobi preconditioner is the inverse of a block-diagonal H, whatever the masses.
BOOST_AUTO_TEST_CASE(uncoupled_particles_are_solved_in_one_iteration) {
  Random random(3);
  BlockLinearSystem system({1e-6, 1.0, 1e6}, {0.3, 0.1},
                           std::make_shared<BlockPattern>(3, std::vector<IndexPair>()));
  fill_definite(system.stiffness(), 100, random);
  system.solver.tolerance = 1e-12;
  Vector y;
  const SolveReport report = system.solve_shifted(implicit_euler(0.5), random.vector(9), y);
  BOOST_TEST((report.status == StepStatus::done));
  BOOST_TEST(report.iterations == 1);
  const SolveReport nothing = system.solve_shifted(implicit_euler(0.5), Vector::Zero(9), y);
  BOOST_TEST((nothing.status == StepStatus::done));
  BOOST_TEST(nothing.iterations == 0);
  BOOST_TEST(y.size() == 9);
  BOOST_TEST(y.isZero(0));
}

BOOST_AUTO_TEST_CASE(an_indefinite_matrix_is_reported_not_solved) {
  // H = 1 + h² K with K = [[a, -c], [-c, a]]: eigenvalues 1 + h² (a ± c).
  const IndexPair pair[] = {{0, 1}};
  BlockLinearSystem system({1, 1}, {}, std::make_shared<BlockPattern>(2, pair));
  const double none[3] = {0, 0, 0};
  const auto set = [&](double a, double c) {
    BlockSparseMatrix& values = system.stiffness();
    values.set_zero();
    for (const int i : {0, 1}) add_isotropic_and_axial(values.block(values.diagonal(i)), a, 0, none);
    add_isotropic_and_axial(values.block(values.find(1, 0)), -c, 0, none);
  };
  Random random(4);
  const Vector rhs = random.vector(6);
  Vector y;
  const auto status = [&](double h) {
    system.solver.preconditioner = Preconditioner::block_jacobi;
    const StepStatus found = system.solve_shifted(implicit_euler(h), rhs, y).status;
    system.solver.preconditioner = Preconditioner::block_ssor;
    BOOST_TEST((system.solve_shifted(implicit_euler(h), rhs, y).status == found));
    system.solver.kind = SolverKind::cholesky;
    BOOST_TEST((system.solve_shifted(implicit_euler(h), rhs, y).status == found));
    system.solver.kind = SolverKind::conjugate_gradients;
    return found;
  };

  set(-1, 0);  // already a diagonal block is negative beyond h = 1
  BOOST_TEST((status(0.99) == StepStatus::done));
  BOOST_TEST((status(1.01) == StepStatus::not_positive_definite));
  set(1, 0);  // and is seen even where the right-hand side does not look
  system.stiffness().block(system.stiffness().diagonal(1))[4] = -1;
  BOOST_TEST((system.solve_shifted(implicit_euler(1.01), Vector::Unit(6, 0), y).status ==
              StepStatus::not_positive_definite));
  set(1, 2);  // diagonal blocks 1 + h², but an eigenvalue 1 - h²
  BOOST_TEST((status(0.99) == StepStatus::done));
  BOOST_TEST((status(1.01) == StepStatus::not_positive_definite));

  for (const SolverKind kind : {SolverKind::conjugate_gradients, SolverKind::cholesky}) {
    system.solver.kind = kind;
    Vector wrong = rhs;
    wrong[4] = nan_value;
    BOOST_TEST((system.solve_shifted(implicit_euler(0.5), wrong, y).status == StepStatus::diverged));
    wrong[4] = inf;
    BOOST_TEST((system.solve_shifted(implicit_euler(0.5), wrong, y).status == StepStatus::diverged));
  }
}

BOOST_AUTO_TEST_CASE(a_matrix_system_is_its_dense_matrices) {
  for (const int n : {1, 4, 13})
    for (const bool damped : {false, true}) BOOST_TEST_CONTEXT("n " << n << ", damped " << damped) {
        Random random(static_cast<std::uint64_t>(7 * n));
        const Dense k = random.definite(n), m = random.definite(n);
        const Dense d = damped ? random.definite(n) : Dense::Zero(n, n);
        MatrixSystem system(prepare(sparse(k), sparse(m), damped ? sparse(d) : SparseMatrix()));
        const Vector x = random.vector(n), v = random.vector(n);
        const auto unmass = [&](const Vector& f) -> Vector { return m.llt().solve(f); };
        Vector out;
        system.acceleration(x, v, out);
        check_equal(out, unmass(-k * x - d * v), 1e-11);
        system.stiffness_times(x, out);
        check_equal(out, unmass(k * x), 1e-11);
        system.damping_times(v, out);
        BOOST_REQUIRE_EQUAL(out.size(), n);
        if (damped) check_equal(out, unmass(d * v), 1e-11);
        if (!damped) BOOST_TEST(out.isZero(0));
        // A factor is kept only while the shift is the same.
        for (const Shift& shift : {implicit_euler(0.1), implicit_euler(2), Shift{3, 2, 4}, Shift{3, 1, 4},
                                   Shift{3, 1, 5}, implicit_euler(0.1)}) {
          const SolveReport report = system.solve_shifted(shift, x, out);
          BOOST_TEST((report.status == StepStatus::done));
          BOOST_TEST((report.iterations == 0 && report.products == 0));
          check_equal(out, (shift.mass * m + shift.damping * d + shift.stiffness * k).llt().solve(m * x),
                      1e-11);
        }
        BOOST_TEST(system.kinetic_energy(v) == 0.5 * v.dot(m * v), boost::test_tools::tolerance(1e-12));
        BOOST_TEST(system.potential_energy(x) == 0.5 * x.dot(k * x), boost::test_tools::tolerance(1e-12));
      }
}

BOOST_AUTO_TEST_CASE(a_matrix_system_reports_an_indefinite_shifted_matrix) {
  const Dense k = Eigen::Vector3d(2, -4, 1).asDiagonal();
  MatrixSystem system(prepare(sparse(k)));
  Vector out;
  const auto status = [&](double h) {
    return system.solve_shifted(implicit_euler(h), Vector::Ones(3), out).status;
  };
  BOOST_TEST((status(0.49) == StepStatus::done));  // 1 - 4h² > 0
  BOOST_TEST((status(0.51) == StepStatus::not_positive_definite));
  BOOST_TEST((status(0.49) == StepStatus::done));
}

// Blocks or matrices, conjugate gradients or Cholesky: one system, one motion.
BOOST_AUTO_TEST_CASE(every_method_moves_a_block_system_as_its_matrix_system) {
  Random random(8);
  BlockLinearSystem blocks = random_system(7, {0.6, 0.05}, true, random);
  blocks.solver.tolerance = 1e-13;
  const DenseSystem dense(blocks);
  MatrixSystem matrices(prepare(sparse(dense.k), sparse(dense.m), sparse(dense.d)));
  const State<Vector> start{random.vector(blocks.size()), random.vector(blocks.size())};
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      State<Vector> one = start, other = start;
      for (int i = 0; i < 4; ++i) {
        BOOST_TEST((method.stepper()->step(blocks, 0.003, one) == StepStatus::done));
        BOOST_TEST((method.stepper()->step(matrices, 0.003, other) == StepStatus::done));
      }
      check_equal(one.x, other.x, 1e-11);
      check_equal(one.v, other.v, 1e-11);
    }
}

// 1 + hC and 1 - hC' solve each other's steps: backward Euler with -h undoes forward Euler with h.
BOOST_AUTO_TEST_CASE(implicit_euler_backwards_undoes_explicit_euler) {
  for (const RayleighDamping& damping : dampings) {
    Random random(9);
    BlockLinearSystem system = random_system(5, damping, true, random);
    for (double& r : std::span(system.own_damping()->block(0), 9 * system.own_damping()->blocks())) r *= 1e-3;
    system.solver.tolerance = 1e-14;
    const double h = 1e-3;
    const State<Vector> start{random.vector(system.size()), random.vector(system.size())};
    State<Vector> state = start;
    BOOST_TEST((Method("explicit-euler").stepper()->step(system, h, state) == StepStatus::done));
    BOOST_TEST((state.v - start.v).norm() > 1e-3);
    BOOST_TEST((Method("implicit-euler").stepper()->step(system, -h, state) == StepStatus::done));
    check_equal(state.x, start.x, 1e-12);
    check_equal(state.v, start.v, 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(prepare_keeps_what_is_right) {
  Random random(21);
  const Dense k = random.definite(5), m = random.definite(5), d = random.definite(5);
  const StructuralMatrices s = prepare(sparse(k), sparse(m), sparse(d));
  BOOST_TEST((Dense(s.stiffness).isApprox(k, 1e-15) && Dense(s.mass).isApprox(m, 1e-15)));
  BOOST_TEST((Dense(s.damping).isApprox(d, 1e-15) && s.has_damping()));
  BOOST_TEST(s.condensed == 0);
  const StructuralMatrices plain = prepare(sparse(-k));  // an indefinite K is a structure that buckles
  BOOST_TEST((Dense(plain.mass) == Dense::Identity(5, 5)));
  BOOST_TEST(!plain.has_damping());
  BOOST_TEST(is_diagonal(plain.mass));
  BOOST_TEST(!is_diagonal(s.mass));
}

BOOST_AUTO_TEST_CASE(asymmetry_is_averaged_away_up_to_a_tolerance_and_refused_above) {
  Random random(22);
  const Dense good = random.definite(4);
  for (const double scale : {1e-30, 1.0, 1e30}) {  // the tolerance is relative
    const double largest =
        scale * std::sqrt(good(1, 1) * good(3, 3));  // that a definite matrix could have there
    const auto with_asymmetry = [&](double a) {
      Dense wrong = scale * good;
      wrong(1, 3) += a * largest;
      return sparse(wrong);
    };
    const SparseMatrix none, unit = sparse(Dense::Identity(4, 4));
    const Dense tolerated = prepare(with_asymmetry(0.9e-10)).stiffness;
    BOOST_TEST((tolerated == tolerated.transpose()));
    BOOST_TEST((tolerated(1, 3) - scale * good(1, 3)) / largest == 0.45e-10,
               boost::test_tools::tolerance(1e-4));
    BOOST_TEST(prepare(unit, with_asymmetry(0.9e-10)).size() == 4);
    expect_refused([&] { prepare(with_asymmetry(1.1e-10)); }, "the stiffness matrix is not symmetric");
    expect_refused([&] { prepare(unit, with_asymmetry(1.1e-10)); }, "the mass matrix is not symmetric");
    expect_refused([&] { prepare(unit, none, with_asymmetry(-1.1e-10)); },
                   "the damping matrix is not symmetric");
  }
  // Also beside what is far larger; and the smallest and the largest numbers are averaged to themselves.
  Dense light = Dense::Identity(3, 3), extreme{{1.7e308, 5e-324}, {5e-324, 1.7e308}};
  light(0, 0) = 1e12;
  light(1, 2) = 3;
  light(2, 1) = -3;
  expect_refused([&] { prepare(sparse(light)); },
                 "the stiffness matrix is not symmetric (entry 3, 2 differs from its mirror image by 6)");
  BOOST_TEST(!prepare_nonsymmetric(sparse(light), {}, {}).symmetric);
  BOOST_TEST((Dense(prepare(sparse(extreme)).stiffness) == extreme));
}

BOOST_AUTO_TEST_CASE(matrices_that_no_structure_has_are_refused_by_name) {
  const auto one = [](int rows, int columns) {
    SparseMatrix a(rows, columns);
    for (int i = 0; i < std::min(rows, columns); ++i) a.insert(i, i) = 1;
    return a;
  };
  const SparseMatrix none;
  expect_refused([&] { prepare(none); }, "the stiffness matrix is empty");
  expect_refused([&] { prepare(one(3, 4)); }, "the stiffness matrix is 3 x 4");
  expect_refused([&] { prepare(one(3, 3), one(4, 4)); }, "the mass matrix is 4 x 4");
  expect_refused([&] { prepare(one(3, 3), one(3, 2)); }, "the mass matrix is 3 x 2");
  expect_refused([&] { prepare(one(3, 3), none, one(2, 2)); }, "the damping matrix is 2 x 2");
  for (const double bad : {nan_value, inf, -inf}) {
    SparseMatrix wrong = one(3, 3);
    wrong.coeffRef(2, 2) = bad;
    expect_refused([&] { prepare(wrong); }, "the stiffness matrix has an entry that is not finite");
    expect_refused([&] { prepare(one(3, 3), wrong); }, "the mass matrix has an entry that is not finite");
    expect_refused([&] { prepare(one(3, 3), none, wrong); },
                   "the damping matrix has an entry that is not finite");
  }
  SparseMatrix negative = one(3, 3);
  negative.coeffRef(1, 1) = -1e-9;
  expect_refused([&] { prepare(one(3, 3), negative); }, "the mass of unknown 2 is -1e-09");
  const Dense indefinite{{1, 2}, {2, 1}}, singular{{1, 1}, {1, 1}}, hollow{{0, 1}, {1, 2}};
  for (const Dense& m : {indefinite, singular, hollow})
    expect_refused([&] { prepare(one(2, 2), sparse(m)); }, "the mass matrix is not positive definite");
  expect_refused([&] { prepare(one(2, 2), sparse(Dense::Zero(2, 2))); }, "the mass matrix is zero");
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {  // singular but for rounding
    Random random(seed);
    const Dense a = random.matrix(6, 5);
    expect_refused([&] { prepare(one(6, 6), sparse(a * a.transpose())); },
                   "the mass matrix is not positive definite");
  }
}

// Finite λ of K u = λ M u are 1/μ for the positive μ of L⁻¹ M L⁻ᵀ, K = LLᵀ: nothing is condensed there.
BOOST_AUTO_TEST_CASE(condensation_keeps_the_finite_eigenvalues_and_the_static_answer) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = 12, massless = 1 + static_cast<int>(seed % 6);
      const Dense k = random.definite(n);
      Dense m = random.definite(n);
      std::set<int> without;
      while (static_cast<int>(without.size()) < massless) without.insert(random.index(n));
      for (const int i : without) m.row(i).setZero(), m.col(i).setZero();

      // An explicit zero in a massless row of the file is no mass.
      SparseMatrix sparse_m = sparse(m);
      sparse_m.coeffRef(*without.begin(), *without.begin()) = 0;
      const StructuralMatrices s = prepare(sparse(k), sparse_m);
      BOOST_TEST(s.condensed == massless);
      BOOST_REQUIRE_EQUAL(s.size(), n - massless);
      BOOST_REQUIRE_EQUAL(s.mass.rows(), n - massless);

      const Eigen::LLT<Dense> factor(k);
      const Dense half = factor.matrixL().solve(m);
      const Dense inverse = factor.matrixL().solve(Dense(half.transpose()));
      const Vector mu = Eigen::SelfAdjointEigenSolver<Dense>(inverse).eigenvalues().tail(n - massless);
      const Vector expected = mu.cwiseInverse().reverse();
      const Vector found =
          Eigen::GeneralizedSelfAdjointEigenSolver<Dense>(Dense(s.stiffness), Dense(s.mass)).eigenvalues();
      // Both sides solve with K and M, whose condition numbers are below 1e4.
      for (Eigen::Index i = 0; i < found.size(); ++i)
        BOOST_TEST(found[i] == expected[i], boost::test_tools::tolerance(1e-9));

      Vector load = Vector::Zero(n), heavy_load(n - massless), answer(n - massless);
      Eigen::Index a = 0;
      for (int i = 0; i < n; ++i)
        if (!without.contains(i)) load[i] = heavy_load[a++] = random(-1, 1);
      const Vector full = factor.solve(load);
      a = 0;
      for (int i = 0; i < n; ++i)
        if (!without.contains(i)) answer[a++] = full[i];
      check_equal(Dense(s.stiffness).llt().solve(heavy_load), answer, 1e-10);
    }
}

BOOST_AUTO_TEST_CASE(condensation_keeps_the_damping_of_what_has_mass) {
  Random random(31);
  const Dense k = random.definite(4), m = Eigen::Vector4d(2, 0, 3, 0).asDiagonal();
  Dense d = Dense::Zero(4, 4);
  d(0, 0) = 5, d(0, 2) = d(2, 0) = 1, d(2, 2) = 7;
  const StructuralMatrices s = prepare(sparse(k), sparse(m), sparse(d));
  BOOST_TEST((Dense(s.damping) == Dense{{5, 1}, {1, 7}}));
  BOOST_TEST((Dense(s.mass) == Dense{{2, 0}, {0, 3}}));

  Dense wrong = d;
  wrong(3, 3) = 1;
  expect_refused([&] { prepare(sparse(k), sparse(m), sparse(wrong)); }, "unknown 4 has damping but no mass");
  wrong = d;
  wrong(0, 1) = wrong(1, 0) = 1;
  expect_refused([&] { prepare(sparse(k), sparse(m), sparse(wrong)); }, "unknown 2 has damping but no mass");
}

// With D = alpha K in the massless rows the finite eigenvalues of μ² M + μ D + K are those of the condensed
// matrices and, once for each massless unknown, -1/alpha: by the linearized pencil, whose massless velocities
// leave infinite ones.
BOOST_AUTO_TEST_CASE(massless_unknowns_damped_like_their_stiffness_are_condensed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = 4 + random.index(5), massless = 1 + random.index(2);
      const double alpha = std::pow(10, random(-2, 0));
      const Dense k = random.definite(n);
      Dense m = Dense::Zero(n, n), d = alpha * k;
      for (int i = massless; i < n; ++i) m(i, i) = 1 + random.index(3);
      d.bottomRightCorner(n - massless, n - massless) += random.definite(n - massless);
      const StructuralMatrices s = prepare(sparse(k), sparse(m), sparse(d));
      BOOST_TEST(s.condensed == massless);
      BOOST_TEST(s.condensed_rate == 1 / alpha, boost::test_tools::tolerance(1e-12));
      const auto rates = generator_spectrum(s).value();
      BOOST_TEST(!rates.empty());
      for (const std::complex<double> mu : rates) {
        const Eigen::MatrixXcd pencil = mu * mu * m + mu * d + k.cast<std::complex<double>>();
        const auto sizes = Eigen::JacobiSVD<Eigen::MatrixXcd>(pencil).singularValues();
        BOOST_TEST(sizes.tail<1>()[0] <= 1e-9 * sizes[0], mu);
      }
      Dense other = d;
      other(0, 0) *= 1.001;
      expect_refused([&] { prepare(sparse(k), sparse(m), sparse(other)); },
                     "has damping but no mass, expected D = alpha K");
    }
}

// Massless unknowns that nothing holds: with a K_bb that is singular but for rounding, K_bb⁻¹ would be noise.
BOOST_AUTO_TEST_CASE(massless_unknowns_that_nothing_holds_are_refused) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = 3 + random.index(20);
      // A free chain of massless particles beside one heavy particle on a spring.
      Dense k = Dense::Zero(n, n), m = Dense::Zero(n, n);
      k(0, 0) = m(0, 0) = 1;
      for (int i = 1; i + 1 < n; ++i) {
        const double spring = std::pow(10, random(-2, 2));
        k(i, i) += spring, k(i + 1, i + 1) += spring;
        k(i, i + 1) = k(i + 1, i) = -spring;
      }
      const std::string words =
          "the stiffness between the " + std::to_string(n - 1) + " massless unknowns is not";
      expect_refused([&] { prepare(sparse(k), sparse(m)); }, words);
      const double scale = std::pow(10, random(-30, 30));
      expect_refused([&] { prepare(sparse(scale * k), sparse(m)); }, words);
      k(n - 1, n - 1) += 1e-6;  // held, if weakly
      BOOST_TEST(prepare(sparse(k), sparse(m)).condensed == n - 1);
    }
  const Dense k{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}, m = Eigen::Vector3d(1, 0, 1).asDiagonal();
  expect_refused([&] { prepare(sparse(k), sparse(m)); }, "the stiffness between the 1 massless unknowns");
}

// Backward stable: ‖b - Hy‖ is some n eps of ‖H‖ ‖y‖, whatever the masses. The pattern of the first call
// serves the others.
BOOST_AUTO_TEST_CASE(a_factorization_solves_to_rounding) {
  for_each_system([](BlockLinearSystem& system, Random& random) {
    const DenseSystem dense(system);
    const Vector rhs = random.vector(system.size()), b = dense.m * rhs;
    system.solver.kind = SolverKind::cholesky;
    for (const Shift& shift : some_shifts) BOOST_TEST_CONTEXT("k " << shift.stiffness) {
        const Dense shifted = dense.shifted(shift);
        Vector y, again;
        const SolveReport report = system.solve_shifted(shift, rhs, y);
        BOOST_TEST((report.status == StepStatus::done));
        BOOST_TEST(report.iterations == 0);
        BOOST_TEST(report.products == 0);
        BOOST_TEST((b - shifted * y).norm() <= 100 * eps * shifted.norm() * y.norm());
        check_equal(y, shifted.llt().solve(b), 1e-9);
        system.solve_shifted(shift, rhs, again);
        BOOST_TEST((again == y));
      }
  });
}

// A chain has a factor without fill, whatever the numbers of its particles; a ring has some.
BOOST_AUTO_TEST_CASE(a_factorization_orders_the_rows_to_keep_the_factor_sparse) {
  constexpr int n = 101;
  for (const bool closed : {false, true}) {
    std::vector<IndexPair> pairs;
    for (int i = 0; i + (closed ? 0 : 1) < n; ++i) pairs.emplace_back(10 * i % n, 10 * (i + 1) % n);
    BlockSparseMatrix k(n, pairs);
    Random random(5);
    fill_definite(k, 1, random);
    BlockCholesky cholesky;
    BOOST_TEST(cholesky.factorize(1, std::vector<double>(n, 1.0), 1, k, 0, nullptr));
    if (closed) {
      BOOST_TEST(cholesky.blocks() >= 2 * n - 3);
      BOOST_TEST(cholesky.blocks() <= 3 * n);
    } else {
      BOOST_TEST(cholesky.blocks() == n - 1);
    }
    const Vector b = random.vector(3 * n);
    Vector y;
    cholesky.solve(b, y);
    const Dense h = Dense(k.to_sparse()) + Dense::Identity(3 * n, 3 * n);
    check_equal(h * y, b, 1e-12);
  }
}

/// The rows of a matrix in the order in which the preconditioner has them below one another.
std::vector<int> sweep_order(const BlockSsor& ssor, int rows) {
  const auto [first, last] = ssor.middle();
  std::vector<int> order;
  for (int i = 0; i < first; ++i) order.push_back(i);
  for (int i = rows - 1; i >= last; --i) order.push_back(i);
  for (auto i = static_cast<int>(first); i < last; ++i) order.push_back(i);
  return order;
}

// Two sides that have nothing in common, about as large, where the rows reach no farther than a band.
BOOST_AUTO_TEST_CASE(a_sweep_has_two_sides_that_do_not_touch) {
  Random random(30);
  for (const int rows : {1, 2, 3, 10, 200}) BOOST_TEST_CONTEXT(rows << " rows") {
      BlockLinearSystem system = random_system(rows, {}, true, random);
      BlockSsor ssor;
      const BlockSparseMatrix &k = system.stiffness(), &c = *system.own_damping();
      BOOST_REQUIRE(ssor.set(1, system.mass(), 1, k, 1, &c));
      const auto [first, last] = ssor.middle();
      BOOST_TEST((0 <= first && first <= last && last <= rows));
      long upper = 0, lower = 0;
      for (const BlockSparseMatrix* a : {&k, &c})
        for (int i = 0; i < rows; ++i)
          for (long place = a->row_begin(i); place < a->diagonal(i); ++place) {
            BOOST_TEST((a->column(place) >= first || i < last));
            (i < first ? upper : lower) += i < first || i >= last;
          }
      if (rows == 200) {
        BOOST_TEST(last - first <= 10);
        BOOST_TEST(std::abs(upper - lower) <= 0.1 * static_cast<double>(upper));
      }
    }
  // Where each row is coupled to the first there is no more than one side.
  std::vector<IndexPair> star;
  for (int i = 1; i < 30; ++i) star.emplace_back(i, 0);
  BlockSparseMatrix k(30, star);
  fill_definite(k, 1, random);
  BlockSsor ssor;
  BOOST_REQUIRE(ssor.set(1, std::vector<double>(30, 1.0), 1, k, 0, nullptr));
  BOOST_TEST((ssor.middle().first == 0 && ssor.middle().last == 30));
}

// ‖b - Hy‖ in the norm of the inverse of (D' + L) D'⁻¹ (D' + Lᵀ), D' = D/ω, L below it in the sweep's order.
BOOST_AUTO_TEST_CASE(over_relaxation_solves_to_its_tolerance_in_its_norm) {
  for_each_system([](BlockLinearSystem& system, Random& random) {
    const DenseSystem dense(system);
    const Vector rhs = random.vector(system.size());
    for (const Shift& shift : some_shifts) {
      const Dense shifted = dense.shifted(shift);
      BlockSsor ssor;
      const int particles = system.stiffness().rows();
      BOOST_REQUIRE(ssor.set(shift.mass + shift.damping * system.damping().d0, system.mass(),
                             shift.of_stiffness(system.damping().alpha), system.stiffness(), shift.damping,
                             system.own_damping()));
      Dense diagonal = Dense::Zero(system.size(), system.size()), lower = diagonal;
      std::vector<int> before;
      for (const int i : sweep_order(ssor, particles)) {
        for (const int j : before) lower.block<3, 3>(3 * i, 3 * j) = shifted.block<3, 3>(3 * i, 3 * j);
        diagonal.block<3, 3>(3 * i, 3 * i) = shifted.block<3, 3>(3 * i, 3 * i) / BlockSsor::relaxation;
        lower.block<3, 3>(3 * i, 3 * i) = diagonal.block<3, 3>(3 * i, 3 * i);
        before.push_back(i);
      }
      const Dense p = lower * diagonal.llt().solve(Dense(lower.transpose()));
      const auto norm = [&](const Vector& r) { return std::sqrt(r.dot(p.llt().solve(r))); };
      const Vector b = dense.m * rhs;
      for (const double tolerance : {1e-2, 1e-6, 1e-12})
        BOOST_TEST_CONTEXT("k " << shift.stiffness << ", " << tolerance) {
          system.solver = {.tolerance = tolerance, .preconditioner = Preconditioner::block_ssor};
          Vector y;
          const SolveReport report = system.solve_shifted(shift, rhs, y);
          BOOST_TEST((report.status == StepStatus::done));
          BOOST_TEST(norm(b - shifted * y) <= (tolerance + 1e-13) * norm(b));
          BOOST_TEST(report.iterations >= 1);
          BOOST_TEST(report.products == report.iterations);
          if (tolerance == 1e-12) check_equal(y, shifted.llt().solve(b), 1e-9);
        }
    }
  });
}

// Ĥ is symmetric, and its curvature along ŷ = (1 + L̂)ᵀ Cᵀ y that of H along y, whether positive or not.
BOOST_AUTO_TEST_CASE(the_over_relaxed_operator_is_symmetric_with_the_curvature_of_the_matrix) {
  Random random(21);
  for (const int particles : {14, 40})
    for (const double shift : {1.0, -0.05}) {
      BlockLinearSystem system = random_system(particles, {}, true, random);
      const BlockSparseMatrix& k = system.stiffness();
      const BlockSparseMatrix* c = system.own_damping();
      Dense h = shift * (Dense(k.to_sparse()) + 0.3 * Dense(c->to_sparse()));
      h += 7 * Dense(lumped_mass(system.mass()));
      BlockSsor ssor;
      const bool usable = ssor.set(7, system.mass(), shift, k, 0.3 * shift, c);
      if (shift > 0) BOOST_REQUIRE(usable);
      if (!usable) continue;
      const auto fours = [&] {
        Vector u = random.vector(4 * k.rows());
        for (Eigen::Index i = 3; i < u.size(); i += 4) u[i] = 0;
        return u;
      };
      const Vector p = fours(), q = fours();
      Vector hp, hq, y;
      const double curvature = ssor.multiply(p, hp);
      ssor.multiply(q, hq);
      BOOST_TEST(q.dot(hp) == p.dot(hq), boost::test_tools::tolerance(1e-10));
      BOOST_TEST(curvature == p.dot(hp), boost::test_tools::tolerance(1e-12));
      ssor.transform_back(p, y);
      BOOST_TEST(curvature == y.dot(h * y), boost::test_tools::tolerance(1e-10));
      for (Eigen::Index i = 3; i < hp.size(); i += 4) BOOST_TEST(hp[i] == 0);
    }
}

BOOST_AUTO_TEST_CASE(over_relaxation_takes_fewer_iterations_to_the_same_solution) {
  BlockLinearSystem system = chain(300, 1e4);
  Random random(22);
  const Vector rhs = random.vector(system.size());
  Vector jacobi, relaxed;
  system.solver = {.tolerance = 1e-10, .preconditioner = Preconditioner::block_jacobi};
  const SolveReport slow = system.solve_shifted(implicit_euler(0.3), rhs, jacobi);
  system.solver.preconditioner = Preconditioner::block_ssor;
  const SolveReport fast = system.solve_shifted(implicit_euler(0.3), rhs, relaxed);
  BOOST_TEST((slow.status == StepStatus::done && fast.status == StepStatus::done));
  check_equal(relaxed, jacobi, 1e-7);
  BOOST_TEST(2 * fast.iterations < slow.iterations);
  const Vector once = relaxed;
  system.solve_shifted(implicit_euler(0.3), rhs, relaxed);
  BOOST_TEST((relaxed == once));
}

BOOST_AUTO_TEST_SUITE_END()
