// Loops that threads share: every part is done once, and what comes out are the same bits with any number of
// threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include "solvers/linear/row_parts.h"
#include "solvers/scene/particle_parts.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"
#include "solvers/team.h"
#include "tests/loop_threads.h"

BOOST_AUTO_TEST_SUITE(threads)

using namespace springstab;
using springstab::test::LoopThreads;

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(random);
}

// Numbers of many sizes: of their sums the order shows.
Vector wild(Random& random, Eigen::Index size) {
  Vector u(size);
  for (double& number : u) number = uniform(random, -1, 1) * std::pow(10, uniform(random, -3, 3));
  return u;
}

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0;
}

Vector values(const BlockSparseMatrix& matrix) {
  return Eigen::Map<const Vector>(matrix.block(0), 9 * matrix.blocks());
}

// Couples each row to some within the bandwidth before it.
SharedPattern banded(Random& random, int rows, int bandwidth) {
  Couplings pairs;
  for (int i = 1; i < rows; ++i)
    for (int again = 0; again < 5; ++again)
      pairs.emplace_back(i, std::uniform_int_distribution<int>(std::max(0, i - bandwidth), i - 1)(random));
  return std::make_shared<BlockPattern>(rows, pairs);
}

BlockSparseMatrix filled(Random& random, const SharedPattern& pattern) {
  BlockSparseMatrix matrix(pattern);
  for (long p = 0; p < matrix.blocks(); ++p)
    for (int r = 0; r < 9; ++r) matrix.block(p)[r] = uniform(random, -1, 1);
  return matrix;
}

/// All that threads share of a scene, at one state.
std::vector<Vector> all_of(Scene& scene, const Vector& x, const Vector& v) {
  std::vector<Vector> all;
  for (const double alpha : {0.0, 0.3}) {
    scene.set_damping({.d0 = 0.7, .alpha = alpha});
    scene.acceleration(x, v, all.emplace_back());
  }
  for (const Hessian hessian : {Hessian::exact, Hessian::projected}) {
    scene.set_hessian(hessian);
    const auto linear = scene.linearization({x, v});
    all.push_back(values(linear->stiffness()));
    if (linear->own_damping()) all.push_back(values(*linear->own_damping()));
    linear->stiffness_times(v, all.emplace_back());
    linear->damping_times(v, all.emplace_back());
    linear->acceleration(x, v, all.emplace_back());
  }
  return all;
}

// `cost`: of a force, a lower bound [ns].
template <class Cloth>
void expect_same_bits(const Cloth& cloth, const std::vector<int>& pinned, double size, double cost) {
  BOOST_TEST(cost > worth_sharing);
  Random random(11);
  const auto made = [&] { return Scene(cloth, pinned, {1, -9.81, 0.5}, {}); };
  Scene scene = made();
  const Vector x = scene.rest_state().x + 0.1 * size * wild(random, scene.size()).cwiseMin(3).cwiseMax(-3);
  const Vector v = wild(random, scene.size());
  const std::vector<Vector> one = all_of(scene, x, v);
  for (const int threads : {2, 3, 5}) {
    const LoopThreads several(threads);
    Scene fresh = made();
    for (Scene* each : {&scene, &fresh}) {
      const std::vector<Vector> again = all_of(*each, x, v);
      BOOST_REQUIRE(again.size() == one.size());
      for (std::size_t i = 0; i < one.size(); ++i)
        BOOST_TEST(same_bits(again[i], one[i]), threads << " threads: " << i);
    }
  }
  const std::vector<Vector> after = all_of(scene, x, v);
  for (std::size_t i = 0; i < one.size(); ++i) BOOST_TEST(same_bits(after[i], one[i]));
}

TetMesh block_of_tetrahedra(int n) {
  TetMesh mesh;
  mesh.source = "block.veg";
  const auto vertex = [n](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) mesh.vertices.emplace_back(i + 0.1 * j, j, k - 0.2 * i);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        std::array<int, 3> axis{0, 1, 2};
        do {  // the six ways along the edges from one corner of a cube to the opposite one
          std::array<int, 3> at{i, j, k};
          std::array<int, 4> tet{vertex(i, j, k)};
          for (int c = 0; c < 3; ++c) {
            ++at[axis[c]];
            tet[c + 1] = vertex(at[0], at[1], at[2]);
          }
          mesh.tets.push_back(tet);
        } while (std::next_permutation(axis.begin(), axis.end()));
      }
  mesh.vertex_line.resize(mesh.vertices.size());
  mesh.tet_line.resize(mesh.tets.size());
  return mesh;
}

}  // namespace

BOOST_AUTO_TEST_CASE(each_part_is_done_once) {
  for (const int count : {1, 2, 3, 7}) {
    const LoopThreads several(count);
    BOOST_TEST(loop_threads() == count);
    for (const int parts : {1, 2, 5, 64})  // with more threads than cores some come late, and often
      for (int again = 0; again < 500; ++again) {
        std::vector<std::atomic<int>> done(parts);
        share(parts, [&](int part) { ++done[part]; });
        for (const auto& times : done) BOOST_REQUIRE(times == 1);
      }
  }
  BOOST_TEST(loop_threads() == 1);
  BOOST_CHECK_THROW(set_loop_threads(0), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(loops_within_loops_and_of_two_callers_are_done_once) {
  const LoopThreads several(3);
  std::atomic<long> sum{0};
  const auto add = [&] {
    for (int again = 0; again < 500; ++again)
      share(4, [&](int i) { share(5, [&](int j) { sum += 10 * i + j; }); });
  };
  std::thread other(add);
  add();
  other.join();
  BOOST_TEST(sum == 1000 * (10 * 6 * 5 + 10 * 4));
}

BOOST_AUTO_TEST_CASE(ranges_cover_what_is_divided) {
  for (const long count : {0L, 1L, 7L, 8L, 100L, 1001L})
    for (const int parts : {1, 2, 3, 9}) {
      long next = 0;
      for (int p = 0; p < parts; ++p) {
        const IndexRange range = part_of(count, p, parts);
        BOOST_TEST(range.first == next);
        BOOST_TEST(range.last >= range.first);
        BOOST_TEST((range.last == count || range.last % 8 == 0));
        next = range.last;
      }
      BOOST_TEST(next == count);
    }
}

BOOST_AUTO_TEST_CASE(products_are_the_same_bits) {
  Random random(7);
  const int rows = 9001, bandwidth = 300;
  const SharedPattern pattern = banded(random, rows, bandwidth);
  const BlockSparseMatrix matrix = filled(random, pattern);
  const Vector in = wild(random, 3L * rows);
  Vector one(in.size()), out(in.size());
  matrix.multiply(in.data(), one.data());
  for (const int threads : {2, 3, 5}) {
    const LoopThreads several(threads);
    BOOST_TEST(RowParts().of(*pattern).size() == static_cast<std::size_t>(threads));
    for (int again = 0; again < 20; ++again) {
      out.setConstant(-1);
      matrix.multiply(in.data(), out.data());
      BOOST_TEST(same_bits(out, one));
    }
    std::vector<int> times(rows);
    matrix.share_rows(in.data(), [&](int i, const Eigen::Vector3d&) { ++times[i]; });
    BOOST_TEST(std::count(times.begin(), times.end(), 1) == rows);
  }
  matrix.multiply(in.data(), out.data());
  BOOST_TEST(same_bits(out, one));
}

// Every block adds to two rows: below and, unless it is on the diagonal, transposed.
BOOST_AUTO_TEST_CASE(parts_of_rows_take_every_block_and_few_twice) {
  Random random(3);
  const SharedPattern pattern = banded(random, 8000, 250);
  const LoopThreads several(4);
  RowParts divided;
  const std::span<const RowPart> parts = divided.of(*pattern);
  BOOST_REQUIRE(parts.size() == 4);
  std::vector<int> transposed(pattern->blocks());
  long next = 0, twice = 0;
  for (const RowPart& part : parts) {
    BOOST_TEST(part.rows.first == next);
    next = part.rows.last;
    for (int i = static_cast<int>(part.rows.first); i < part.rows.last; ++i)
      for (long p = pattern->row_begin(i); p < pattern->diagonal(i); ++p) {
        BOOST_TEST((i < part.inner || part.rows.holds(pattern->column(p))));
        transposed[p] += part.rows.holds(pattern->column(p));
      }
    for (const RowPart::Below& below : part.below)
      for (long p = below.first; p < below.last; ++p, ++twice) {
        BOOST_TEST(below.row >= part.rows.last);
        BOOST_TEST(part.rows.holds(pattern->column(p)));
        ++transposed[p];
      }
  }
  BOOST_TEST(next == pattern->rows());
  BOOST_TEST(twice > 0);
  BOOST_TEST(twice < pattern->blocks() / 5);
  for (int i = 0; i < pattern->rows(); ++i)
    for (long p = pattern->row_begin(i); p <= pattern->diagonal(i); ++p)
      BOOST_TEST(transposed[p] == (p < pattern->diagonal(i)));
  BOOST_TEST(RowParts().of(*banded(random, 8000, 8000)).empty());  // the parts would read most of each other
  BOOST_TEST(RowParts().of(*banded(random, 200, 20)).empty());     // small
}

BOOST_AUTO_TEST_CASE(parts_of_particles_take_every_batch_in_order) {
  const int batches = 300;
  const long particles = 5000;
  const auto touches = [&](int batch, const IndexRange& r) {  // some 50 particles each
    return r.first < batch * 16 + 50 && r.last > batch * 16;
  };
  const LoopThreads several(3);
  std::vector<std::atomic<int>> done(batches);
  std::array<std::atomic<int>, 3> last{-1, -1, -1};
  std::atomic<bool> small{true}, ascending{true};
  ParticleParts parts;
  parts.share(batches, particles, 1e9, touches, [&](int batch, const IndexRange& mine) {
    ++done[batch];
    if (mine.last - mine.first > particles / 2) small = false;
    if (last[(mine.first + 8) * 3 / particles].exchange(batch) >= batch) ascending = false;
  });
  BOOST_TEST(small);
  BOOST_TEST(ascending);
  const long twice = std::count(done.begin(), done.end(), 2);
  BOOST_TEST(std::count(done.begin(), done.end(), 1) + twice == batches);
  BOOST_TEST(twice > 0);
  BOOST_TEST(twice < 20);
  const auto alone = [&](double cost, const auto& touching) {  // all in one part
    int next = 0;
    ParticleParts().share(batches, particles, cost, touching, [&](int batch, const IndexRange& mine) {
      BOOST_CHECK(batch == next++);
      BOOST_CHECK(mine.first == 0 && mine.last == particles);
    });
    BOOST_TEST(next == batches);
  };
  alone(1e9, [](int, const IndexRange&) { return true; });
  alone(worth_sharing / 2, touches);
}

BOOST_AUTO_TEST_CASE(spring_nets_are_the_same_bits) {
  const SpringNet net =
      make_net(Grid{.rows = 71, .columns = 83}, {.stiffness = {200, 100, 20}, .damping = {0.1, 0.2, 0.3}});
  expect_same_bits(net, {0, 1, 82, 1000, 3111, 3112, 5892}, 0.025,
                   5. * static_cast<double>(net.springs.size()));
}

BOOST_AUTO_TEST_CASE(cloth_of_triangles_is_the_same_bits) {
  const TriangleCloth cloth = make_cloth(Grid{.rows = 52, .columns = 47, .diagonals = Diagonals::alternating},
                                         {.damping = {0.1, 0.2, 0.3, 1e-6}});
  expect_same_bits(cloth, {0, 46, 1200}, 0.025, 20. * static_cast<double>(cloth.triangles.size()));
}

BOOST_AUTO_TEST_CASE(solids_are_the_same_bits) {
  const TetSolid solid = make_solid(block_of_tetrahedra(9), {.damping = {0.1, 0.2}});
  expect_same_bits(solid, {0, 5, 77, 999}, 1, 20. * static_cast<double>(solid.altitudes.size()));
}

// With either preconditioner, also where a matrix is too small to be shared, or its vectors are.
BOOST_AUTO_TEST_CASE(conjugate_gradients_are_the_same_bits) {
  Random random(12);
  for (const int rows : {5, 40, 131}) {
    const SpringNet net = make_net(Grid{.rows = rows, .columns = 128},
                                   {.stiffness = {200, 100, 20}, .damping = {0.1, 0.2, 0.3}});
    Scene scene(net, {0, 1, 64}, {0, -9.81, 0}, {.d0 = 1, .alpha = 1e-3});
    for (const Preconditioner preconditioner : {Preconditioner::block_ssor, Preconditioner::block_jacobi}) {
      scene.solver() = {.tolerance = 1e-3, .max_iterations = 30, .preconditioner = preconditioner};
      const auto linear = scene.linearization(scene.rest_state());
      const Vector right = wild(random, scene.size());
      const auto solve = [&](Vector& out) {
        return linear->solve_shifted({1, 0.01, 1e-4}, right, out).iterations;
      };
      Vector one, again;
      const long iterations = solve(one);
      BOOST_TEST(iterations > 1);
      for (const int threads : {2, 3, 5}) {
        const LoopThreads several(threads);
        BOOST_TEST(solve(again) == iterations);
        BOOST_TEST(same_bits(again, one), rows << " rows, " << threads << " threads");
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
