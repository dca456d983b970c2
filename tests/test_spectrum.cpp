// Spectra: what ARPACK finds is what is known of chains, membranes and real structures, k0 lies between its
// two numbers, limits follow from it, and every way in which ARPACK can mislead is caught.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "analysis/limits/method_limits.h"
#include "analysis/method.h"
#include "analysis/proofs/definiteness.h"
#include "analysis/spectra/arpack.h"
#include "analysis/spectra/chebyshev_filter.h"
#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/transition_operator.h"
#include "solvers/io/matrix_file.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/spring_cloth.h"
#include "tests/random_nets.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(spectrum)

using namespace springstab;

namespace {

using Dense = Eigen::MatrixXd;
using boost::test_tools::tolerance;

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();
const double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979323846;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  int index(int size) { return std::uniform_int_distribution(0, size - 1)(engine_); }
  Dense matrix(Eigen::Index rows, Eigen::Index columns) {
    Dense a(rows, columns);
    for (double& entry : a.reshaped()) entry = (*this)(-1, 1);
    return a;
  }
  Dense definite(Eigen::Index size) {
    const Dense a = matrix(size, size);
    return a * a.transpose() + 0.1 * Dense::Identity(size, size);
  }

 private:
  std::mt19937_64 engine_;
};

SparseMatrix sparse(const Dense& a) { return a.sparseView(0.0, 0.0); }

SparseMatrix diagonal(const Vector& d) { return SparseMatrix(d.asDiagonal()); }

struct Link {
  int i, j;  // -1: the wall
  double k;
};

/// The stiffness matrix of masses on a line, joined by springs.
SparseMatrix stiffness(int n, const std::vector<Link>& links) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [i, j, k] : links) {
    if (i >= 0) entries.emplace_back(i, i, k);
    if (j >= 0) entries.emplace_back(j, j, k);
    if (i >= 0 && j >= 0) entries.emplace_back(i, j, -k), entries.emplace_back(j, i, -k);
  }
  SparseMatrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

SparseMatrix chain(int n, bool first_wall, bool second_wall) {
  std::vector<Link> links;
  if (first_wall) links.push_back({-1, 0, 1});
  for (int i = 0; i + 1 < n; ++i) links.push_back({i, i + 1, 1});
  if (second_wall) links.push_back({n - 1, -1, 1});
  return stiffness(n, links);
}

SparseMatrix fixed_chain(int n) { return chain(n, true, true); }

double fixed_chain_k0(int n) { return 4 * std::pow(std::cos(pi / (2 * (n + 1))), 2); }

LinearOperator product_with(const SparseMatrix& a) {
  return {a.rows(), [&a](const Vector& in, Vector& out) { out = a * in; }};
}

/// A pencil whose largest eigenvalues are known, largest first.
struct Known {
  std::string name;
  SparseMatrix k, m;
  std::vector<double> largest;
  bool simple = true;  // no eigenvalue is double
};

std::vector<Known> known_spectra() {
  const auto sine = [](double numerator, double denominator) {
    return 4 * std::pow(std::sin(pi * numerator / denominator), 2);
  };
  std::vector<Known> all;
  const int n = 300;
  SparseMatrix one(n, n);
  one.setIdentity();
  all.push_back({"fixed-fixed", chain(n, true, true), one, {}});
  for (int j = n; j > n - 5; --j) all.back().largest.push_back(sine(j, 2 * (n + 1)));
  all.push_back({"fixed-free", chain(n, true, false), one, {}});
  for (int j = n; j > n - 5; --j) all.back().largest.push_back(sine(2 * j - 1, 2 * (2 * n + 1)));
  all.push_back({"free-free", chain(n, false, false), one, {}});
  for (int j = n - 1; j > n - 6; --j) all.back().largest.push_back(sine(j, 2 * n));

  std::vector<Link> ring;
  for (int i = 0; i < n; ++i) ring.push_back({i, (i + 1) % n, 1});
  all.push_back({"ring", stiffness(n, ring), one, {4}, false});
  for (int j = n / 2 - 1; j > n / 2 - 6; --j)
    all.back().largest.insert(all.back().largest.end(), 2, sine(j, n));

  const int side = 20;
  std::vector<Link> membrane;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const int p = side * i + j;
      membrane.push_back({j > 0 ? p - 1 : -1, p, 1});
      membrane.push_back({i > 0 ? p - side : -1, p, 1});
      if (j == side - 1) membrane.push_back({p, -1, 1});
      if (i == side - 1) membrane.push_back({p, -1, 1});
    }
  SparseMatrix one_each(side * side, side * side);
  one_each.setIdentity();
  all.push_back({"membrane", stiffness(side * side, membrane), one_each, {}, false});
  std::vector<double> line;
  for (int j = side; j > 0; --j) line.push_back(sine(j, 2 * (side + 1)));
  for (const double a : line)
    for (const double b : line) all.back().largest.push_back(a + b);
  std::sort(all.back().largest.rbegin(), all.back().largest.rend());

  const int masses = 200;
  std::vector<Link> mikota;
  Vector weight(masses);
  for (int i = 0; i < masses; ++i) {
    mikota.push_back({i - 1, i, static_cast<double>(masses - i)});
    weight[i] = 1.0 / (i + 1);
  }
  all.push_back({"Mikota", stiffness(masses, mikota), diagonal(weight), {}});
  for (int j = masses; j > masses - 5; --j) all.back().largest.push_back(static_cast<double>(j) * j);
  return all;
}

/// Checks that the values are eigenvalues of the known spectrum, in order, the largest among them.
void check_largest(const std::vector<double>& values, const std::vector<double>& known) {
  BOOST_REQUIRE(!values.empty());
  BOOST_TEST(values.front() == known.front(), tolerance(1e-10));
  auto next = known.begin();
  for (const double value : values) {
    next = std::find_if(next, known.end(), [&](double k) { return k <= value * (1 + 1e-10); });
    BOOST_REQUIRE((next != known.end()));
    BOOST_TEST(value == *next++, tolerance(1e-10));
  }
}

using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// A positive definite pencil with consistent mass whose masses span twelve powers of ten, and its k0.
struct RandomPencil {
  Dense k, m;
  double k0;

  RandomPencil(int n, std::uint64_t seed) {
    Random random(seed);
    Vector scale(n);
    for (double& entry : scale) entry = std::pow(10, random(-3, 3));
    if (n > 1) scale[0] = 1e-3, scale[n - 1] = 1e3;
    const Dense coupled = 0.4 / n * random.matrix(n, n);
    const Dense unit = Dense::Identity(n, n) + coupled + coupled.transpose();
    m = scale.asDiagonal() * unit * scale.asDiagonal();
    k = scale.asDiagonal() * random.definite(n) * scale.asDiagonal();
    k = (0.5 * (k + k.transpose())).eval();
    m = (0.5 * (m + m.transpose())).eval();
    // In extended precision, scaled so that the masses do not matter.
    const auto d = scale.cast<long double>().cwiseInverse().asDiagonal();
    const Wide wide_k = d * k.cast<long double>() * d, wide_m = d * m.cast<long double>() * d;
    k0 = static_cast<double>(
        Eigen::GeneralizedSelfAdjointEigenSolver<Wide>(wide_k, wide_m, Eigen::EigenvaluesOnly)
            .eigenvalues()
            .maxCoeff());
  }
};

/// Both on one diagonal.
SparseMatrix direct_sum(const SparseMatrix& a, const SparseMatrix& b) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](const SparseMatrix& part, int at) {
    for (int j = 0; j < part.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(part, j); it; ++it)
        entries.emplace_back(at + static_cast<int>(it.row()), at + static_cast<int>(it.col()), it.value());
  };
  add(a, 0);
  add(b, static_cast<int>(a.rows()));
  SparseMatrix sum(a.rows() + b.rows(), a.rows() + b.rows());
  sum.setFromTriplets(entries.begin(), entries.end());
  return sum;
}

/// value <= k0 < upper_bound, both close to it; rounding alone may lift the value.
void check_encloses(const StiffestMode& mode, double k0, double rounding = 1e-12) {
  BOOST_TEST(mode.converged);
  BOOST_TEST(mode.value == k0, tolerance(1e-8));
  BOOST_TEST(mode.value <= k0 * (1 + rounding));
  BOOST_TEST(mode.upper_bound > k0);
  BOOST_TEST(mode.upper_bound / k0 - 1 < 1e-6);
}

/// The problems of expected.json as they are there.
std::vector<nlohmann::json> problems() {
  const auto path = test::shared_data("matrices/expected.json");
  if (!path) return {};
  std::ifstream file(*path);
  return nlohmann::json::parse(file);
}

StructuralMatrices load(const nlohmann::json& problem) {
  const auto read = [&](const char* key) {
    const std::string name = problem.at(key);
    return name == "I" ? SparseMatrix() : read_matrix(test::shared_data("matrices/" + name).value().string());
  };
  return prepare(read("K"), read("M"));
}

StiffestMode exactly(double k0) {
  StiffestMode mode;
  mode.converged = true;
  mode.value = k0;
  mode.upper_bound = k0 * (1 + 1e-9);
  return mode;
}

DampingModel rayleigh(double d0, double alpha) { return {DampingModel::Kind::rayleigh, d0, alpha}; }

/// A cloth hung by its first row and stretched by a few percent either way, so that K is positive definite.
Scene stretched_cloth(int rows, int columns, RayleighDamping damping) {
  const SpringNet net = make_net(Grid{rows, columns}, SpringMaterial{});
  std::vector<int> pinned;
  std::vector<Eigen::Vector3d> places;
  for (int j = 0; j < columns; ++j) {
    pinned.push_back(j);
    places.push_back(net.rest[j].cwiseProduct(Eigen::Vector3d(1.03, 1, 1.07)));
  }
  Scene scene(net, pinned, {0, -9.81, 0}, damping);
  scene.place_pinned(places);
  return scene;
}

BlockLinearSystem stretched(Scene& scene) {
  State<Vector> state = scene.rest_state();
  for (Eigen::Index i = 0; i < state.x.size(); i += 3) state.x[i] *= 1.03, state.x[i + 2] *= 1.07;
  return *scene.linearization(state);
}

StructuralMatrices matrices_of(BlockLinearSystem& system) {
  return prepare(system.stiffness().to_sparse(), lumped_mass(system.mass()));
}

/// max |λ| over the modes, each through the method's own step on its oscillator.
double modal_radius(std::string_view method, const Vector& squares, RayleighDamping damping, double h) {
  double radius = 0;
  for (const double k : squares) {
    const Dense a = Method(method).amplification(h * (damping.d0 + damping.alpha * k), h * h * k);
    radius = std::max(radius, test::largest_modulus(a));
  }
  return radius;
}

}  // namespace

BOOST_AUTO_TEST_CASE(arpack_finds_the_spectra_that_are_known) {
  for (const Known& known : known_spectra()) BOOST_TEST_CONTEXT(known.name) {
      const Vector d = known.m.diagonal().cwiseSqrt().cwiseInverse();
      const SparseMatrix s = diagonal(d) * known.k * diagonal(d);
      const SymmetricEigenpairs found = largest_eigenpairs(product_with(s), 4);
      BOOST_REQUIRE(found.converged);
      BOOST_REQUIRE_EQUAL(found.values.size(), 4U);
      BOOST_REQUIRE_EQUAL(found.vectors.cols(), 4);
      check_largest(found.values, known.largest);
      for (int i = 0; i < 4; ++i) BOOST_TEST_CONTEXT("eigenvalue " << i) {
          const double value = found.values[i];
          if (known.simple) BOOST_TEST(value == known.largest[i], tolerance(1e-10));
          const double residual = (s * found.vectors.col(i) - value * found.vectors.col(i)).norm();
          BOOST_TEST(residual <= 2e-10 * value);
          BOOST_TEST(std::abs(residual - found.residuals[i]) <= 100 * eps * value);
        }
      const Dense gram = found.vectors.transpose() * found.vectors;
      BOOST_TEST((gram - Dense::Identity(4, 4)).norm() < 1e-10);
      BOOST_TEST(found.products > 20);
      BOOST_TEST(found.products < 5000);

      const StiffestMode mode = stiffest_mode(prepare(known.k, known.m));
      check_encloses(mode, known.largest[0]);
      BOOST_TEST(mode.value == known.largest[0], tolerance(1e-13));  // the residual's square
      BOOST_TEST(mode.residual <= 2e-10 * mode.value);
      BOOST_TEST(mode.products > 0);
      BOOST_TEST(!mode.indefinite);
      BOOST_TEST(!mode.smallest.has_value());
    }
}

BOOST_AUTO_TEST_CASE(an_eigenvalue_scales_with_the_unit_of_time) {
  const int n = 200;
  for (const double scale : {1e-200, 1e-20, 1e-12, 1.0, 1e20, 1e200}) BOOST_TEST_CONTEXT("scale " << scale) {
      const SparseMatrix a = scale * fixed_chain(n);
      const SymmetricEigenpairs found = largest_eigenpairs(product_with(a), 1);
      BOOST_REQUIRE(found.converged);
      BOOST_TEST(found.values[0] == scale * fixed_chain_k0(n), tolerance(1e-13));
      BOOST_TEST(found.residuals[0] <= 2e-10 * found.values[0]);
      BOOST_TEST(found.residuals[0] >= 1e-14 * found.values[0]);
      check_encloses(stiffest_mode(prepare(a)), scale * fixed_chain_k0(n));
      check_encloses(stiffest_mode(prepare(scale * fixed_chain(30))), scale * fixed_chain_k0(30));
    }
}

BOOST_AUTO_TEST_CASE(a_filtered_solve_finds_the_same_eigenvalue_to_the_same_residual) {
  for (const auto& known : known_spectra()) {
    if (known.k.rows() <= 3 * dense_limit / 4) continue;
    const StructuralMatrices s = prepare(known.k, known.m);
    LinearOperator bounded = scaled_stiffness(s);
    if (!std::isfinite(bounded.lowest)) bounded.lowest = 0;  // consistent masses
    const double k0 = largest_eigenpairs(bounded, 1).values.at(0);
    for (const double wanted : {1e-3, 1e-6, 1e-9}) BOOST_TEST_CONTEXT(known.name << " to " << wanted) {
        const SymmetricEigenpairs found = largest_eigenpair(bounded, {.tolerance = wanted});
        BOOST_REQUIRE(found.converged);
        BOOST_TEST(found.residuals.at(0) <= 1.2 * wanted * k0);
        BOOST_TEST(found.values.at(0) <= (1 + 1e-13) * k0);
        BOOST_TEST(found.values[0] >= (1 - wanted) * k0);
        Vector image;
        bounded.apply(found.vectors.col(0), image);
        image -= found.values[0] * found.vectors.col(0);
        BOOST_TEST(image.stableNorm() == found.residuals[0]);
        BOOST_TEST(found.vectors.col(0).norm() == 1, tolerance(1e-12));
      }
  }
}

// Each step is a product with the polynomial, of degree 16.
BOOST_AUTO_TEST_CASE(a_filter_leaves_a_fifth_of_the_steps_where_the_largest_eigenvalues_lie_close) {
  for (const int n : {300, 1000}) BOOST_TEST_CONTEXT(n << " particles") {
      const StructuralMatrices s = prepare(fixed_chain(n));
      const LinearOperator a = scaled_stiffness(s);
      const SymmetricEigenpairs filtered = largest_eigenpair(a, {.tolerance = 1e-6}),
                                plain = largest_eigenpairs(a, 1, {.tolerance = 1e-6});
      BOOST_TEST(filtered.converged);
      BOOST_TEST(filtered.products / 16 <= plain.products / 5);
    }
}

BOOST_AUTO_TEST_CASE(a_filter_passes_over_what_is_far_below_zero) {
  for (const double lowest : {-0.5, -1.0, -30.0}) BOOST_TEST_CONTEXT("from " << lowest) {
      Vector d(300);
      for (int i = 0; i < 300; ++i) d[i] = lowest + (1 - lowest) * ((37 * i) % 300) / 299.0;
      const SparseMatrix a = diagonal(d);
      const LinearOperator s = scaled_stiffness(prepare(a));
      BOOST_TEST(s.lowest == lowest);
      BOOST_TEST(s.highest == 1);
      BOOST_TEST(largest_eigenpair(s).values.at(0) == 1, tolerance(1e-12));
    }
}

BOOST_AUTO_TEST_CASE(no_eigenvalue_lies_beyond_the_bounds_of_an_operator) {
  Random random(77);
  int indefinite = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 2 + random.index(20);
    Dense k = random.matrix(n, n).cwiseProduct(random.matrix(n, n).cwiseAbs2());
    k = (k + k.transpose()).eval();
    Vector m(n);
    for (double& entry : m) entry = std::exp(random(-5, 5));
    const StructuralMatrices s = prepare(sparse(k), diagonal(m));
    const LinearOperator op = scaled_stiffness(s);
    const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Dense>(as_dense(op)).eigenvalues();
    const double rounding = 10 * eps * op.highest;
    BOOST_TEST(op.lowest <= eigenvalues[0] + rounding);
    BOOST_TEST(op.highest >= eigenvalues[n - 1] - rounding);
    indefinite += eigenvalues[0] < 0;
  }
  BOOST_TEST(indefinite > 50);
}

// A chain after a change of variables that leaves its eigenvalues but not its symmetry.
BOOST_AUTO_TEST_CASE(many_unknowns_that_are_not_symmetric_have_a_stiffest_mode) {
  const int n = 600;
  Vector grade(n);
  for (int i = 0; i < n; ++i) grade[i] = std::pow(1.001, i);
  const SparseMatrix chain = fixed_chain(n);
  const StructuralMatrices s =
      prepare_nonsymmetric(SparseMatrix(diagonal(grade) * chain * diagonal(grade.cwiseInverse())));
  BOOST_REQUIRE(!s.symmetric);
  const StiffestMode mode = stiffest_mode(s);
  BOOST_REQUIRE(mode.converged);
  BOOST_TEST(mode.value == fixed_chain_k0(n), tolerance(1e-9));
  BOOST_TEST(mode.residual < 1e-6 * mode.value);
  BOOST_TEST(mode.upper_bound >= fixed_chain_k0(n));
  BOOST_TEST(!mode.smallest);
}

BOOST_AUTO_TEST_CASE(the_largest_of_negative_eigenvalues_is_the_one_nearest_to_zero) {
  Vector d(200);
  for (int i = 0; i < 200; ++i) d[i] = -1 - 0.05 * ((17 * i) % 200);
  const SparseMatrix a = diagonal(d);
  const SymmetricEigenpairs found = largest_eigenpairs(product_with(a), 2);
  BOOST_REQUIRE(found.converged);
  BOOST_TEST(found.values[0] == -1, tolerance(1e-10));
  BOOST_TEST(found.values[1] == -1.05, tolerance(1e-10));
  const StiffestMode mode = stiffest_mode(prepare(a));
  BOOST_TEST(mode.value == -1, tolerance(1e-10));
  BOOST_TEST(mode.upper_bound > -1);
  BOOST_TEST(mode.upper_bound < -1 + 1e-6);
  BOOST_TEST(mode.indefinite);
}

BOOST_AUTO_TEST_CASE(a_product_that_is_not_finite_is_refused) {
  const SparseMatrix a = fixed_chain(200);
  for (const double bad : {nan_value, infinity, -infinity})
    for (const int after : {0, 1, 30}) BOOST_TEST_CONTEXT(bad << " after " << after << " products") {
        int products = 0;
        const LinearOperator op{200, [&](const Vector& in, Vector& out) {
                                  out = a * in;
                                  if (products++ >= after) out[7] = bad;
                                }};
        BOOST_CHECK_THROW(largest_eigenpairs(op, 1), std::invalid_argument);
        products = 0;
        BOOST_CHECK_THROW(dominant_eigenvalues(op, 1), std::invalid_argument);
        // and nothing is left behind
        BOOST_TEST(largest_eigenpairs(product_with(a), 1).values.at(0) == fixed_chain_k0(200),
                   tolerance(1e-10));
      }
  const LinearOperator shorter{200, [](const Vector&, Vector& out) { out = Vector::Ones(199); }};
  BOOST_CHECK_THROW(largest_eigenpairs(shorter, 1), std::invalid_argument);
  SparseMatrix tiny(200, 200), tinier(3, 3);
  tiny.setIdentity(), tinier.setIdentity();
  BOOST_CHECK_THROW(stiffest_mode(prepare(1e300 * a, 1e-20 * tiny)), std::invalid_argument);
  BOOST_CHECK_THROW(stiffest_mode(prepare(1e300 * tinier, 1e-20 * tinier)), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(nothing_but_zero_has_the_eigenvalue_zero_at_once) {
  const SparseMatrix zero(200, 200);
  const SymmetricEigenpairs found = largest_eigenpairs(product_with(zero), 2);
  BOOST_TEST(found.converged);
  BOOST_TEST((found.values == std::vector<double>{0, 0}));
  BOOST_TEST((found.residuals == std::vector<double>{0, 0}));
  BOOST_TEST((found.vectors.transpose() * found.vectors == Dense::Identity(2, 2)));
  const Eigenvalues dominant = dominant_eigenvalues(product_with(zero), 2);
  BOOST_TEST(dominant.converged);
  BOOST_TEST((dominant.values == std::vector<std::complex<double>>{0, 0}));

  Vector d = Vector::Zero(200);
  d[13] = -3;
  const SparseMatrix almost = diagonal(d);
  BOOST_TEST(std::abs(largest_eigenpairs(product_with(almost), 1).values.at(0)) < 1e-14);
  BOOST_TEST(dominant_eigenvalues(product_with(almost), 1).values.at(0).real() == -3, tolerance(1e-10));
}

BOOST_AUTO_TEST_CASE(what_did_not_converge_is_not_reported) {
  const SparseMatrix a = fixed_chain(1000);
  const ArpackOptions hopeless{.basis_size = 3, .max_restarts = 2};
  const SymmetricEigenpairs found = largest_eigenpairs(product_with(a), 1, hopeless);
  BOOST_TEST(!found.converged);
  BOOST_TEST((found.values.empty() && found.residuals.empty() && found.vectors.cols() == 0));
  BOOST_TEST(found.products > 3);
  const Eigenvalues dominant = dominant_eigenvalues(product_with(a), 1, hopeless);
  BOOST_TEST(!dominant.converged);
  BOOST_TEST(dominant.values.empty());

  const StiffestMode mode = stiffest_mode(prepare(a), hopeless);
  BOOST_TEST(!mode.converged);
  BOOST_TEST(mode.upper_bound == 4, tolerance(1e-10));  // Gershgorin's
  BOOST_TEST((mode.bound_kind == BoundKind::gershgorin));
  for (const Method& method : all_methods())
    for (const DampingModel& damping : {DampingModel{}, rayleigh(0.1, 0.1)})
      BOOST_TEST_CONTEXT(method.name()) {
        const MethodLimits limits = method_limits(method.name(), mode, damping, 1.5);
        BOOST_TEST((limits.status == LimitStatus::unknown));
        BOOST_TEST((!limits.h_max && !limits.h_certified && !limits.recommended && !limits.designed));
      }
}

BOOST_AUTO_TEST_CASE(of_several_eigenvalues_only_those_that_converged_are_reported) {
  const Known mikota = known_spectra().back();
  const Vector d = mikota.m.diagonal().cwiseSqrt().cwiseInverse();
  const SparseMatrix s = diagonal(d) * mikota.k * diagonal(d);
  int partial = 0;
  for (int restarts = 1; restarts < 12; ++restarts) BOOST_TEST_CONTEXT(restarts << " restarts") {
      const SymmetricEigenpairs found =
          largest_eigenpairs(product_with(s), 10, {.basis_size = 22, .max_restarts = restarts});
      partial += !found.converged && !found.values.empty();
      BOOST_TEST((found.values.size() == 10) == found.converged);
      for (std::size_t i = 0; i < found.values.size(); ++i) {
        const double j = 200 - static_cast<double>(i);
        BOOST_TEST(found.values[i] == j * j, tolerance(1e-10));
        BOOST_TEST(found.residuals[i] <= 2e-10 * found.values[i]);
      }
    }
  BOOST_TEST(partial > 2);
}

BOOST_AUTO_TEST_CASE(impossible_numbers_of_eigenvalues_are_refused) {
  const SparseMatrix a = fixed_chain(6);
  for (const int count : {-1, 0, 6, 7})
    BOOST_CHECK_THROW(largest_eigenpairs(product_with(a), count), std::invalid_argument);
  for (const int count : {-1, 0, 5, 6})
    BOOST_CHECK_THROW(dominant_eigenvalues(product_with(a), count), std::invalid_argument);
  const SymmetricEigenpairs most = largest_eigenpairs(product_with(a), 5);
  BOOST_REQUIRE_EQUAL(most.values.size(), 5U);
  for (int i = 0; i < 5; ++i)
    BOOST_TEST(most.values[i] == 4 * std::pow(std::sin(pi * (6 - i) / 14), 2), tolerance(1e-12));
  BOOST_TEST(dominant_eigenvalues(product_with(a), 4).values.size() >= 4);
}

BOOST_AUTO_TEST_CASE(impossible_operators_and_start_vectors_are_refused) {
  BOOST_CHECK_THROW(start_vector(0, {}, 1), std::invalid_argument);
  for (const Vector& start :
       {Vector(Vector::Ones(5)), Vector(Vector::Zero(6)), Vector(Vector::Constant(6, nan_value))})
    BOOST_CHECK_THROW(start_vector(6, start, 1), std::invalid_argument);
  const LinearOperator vast{3'000'000'000, [](const Vector& in, Vector& out) { out = in; }};
  BOOST_CHECK_THROW(largest_eigenpairs(vast, 1), std::invalid_argument);
  const LinearOperator shorter{6, [](const Vector& in, Vector& out) { out = in.head(5); }};
  BOOST_CHECK_THROW(largest_eigenpairs(shorter, 1), std::invalid_argument);
  BOOST_CHECK_THROW(dominant_eigenvalues(shorter, 1), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(complex_eigenvalues_come_in_pairs_of_their_modulus) {
  // Blocks r (cos, -sin; sin, cos): eigenvalues r exp(±iφ).
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 60; ++i) {
    const double r = 2 - i / 40.0, angle = 0.4 + i;
    entries.emplace_back(2 * i, 2 * i, r * std::cos(angle));
    entries.emplace_back(2 * i + 1, 2 * i + 1, r * std::cos(angle));
    entries.emplace_back(2 * i, 2 * i + 1, -r * std::sin(angle));
    entries.emplace_back(2 * i + 1, 2 * i, r * std::sin(angle));
  }
  for (const double scale : {1.0, 1e-20}) {
    SparseMatrix a(120, 120);
    a.setFromTriplets(entries.begin(), entries.end());
    a *= scale;
    const Eigenvalues found =
        dominant_eigenvalues(product_with(a), 3);  // ARPACK adds the third one's conjugate
    BOOST_REQUIRE(found.converged);
    BOOST_REQUIRE_EQUAL(found.values.size(), 4U);
    for (int i = 0; i < 4; ++i) {
      const int pair = i / 2;
      BOOST_TEST(std::abs(found.values[i]) == scale * (2 - pair / 40.0), tolerance(1e-10));
      BOOST_TEST(found.values[i].real() == scale * (2 - pair / 40.0) * std::cos(0.4 + pair), tolerance(1e-9));
    }
    BOOST_TEST(found.values[0].imag() == -found.values[1].imag(), tolerance(1e-12));
  }
}

BOOST_AUTO_TEST_CASE(two_threads_are_served_one_after_the_other) {
  std::vector<std::vector<double>> found(4);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([t, &found] {
      const SparseMatrix a = fixed_chain(150 + 25 * t);
      for (int i = 0; i < 3; ++i) found[t].push_back(largest_eigenpairs(product_with(a), 1).values.at(0));
    });
  for (std::thread& thread : threads) thread.join();
  for (int t = 0; t < 4; ++t)
    for (const double value : found[t]) BOOST_TEST(value == fixed_chain_k0(150 + 25 * t), tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_solve_inside_a_product_is_an_error) {
  const SparseMatrix a = fixed_chain(200);
  const LinearOperator nested{200, [&](const Vector& in, Vector& out) {
                                out = largest_eigenpairs(product_with(a), 1).values.at(0) * in;
                              }};
  BOOST_CHECK_THROW(largest_eigenpairs(nested, 1), std::logic_error);
  BOOST_CHECK_THROW(dominant_eigenvalues(nested, 1), std::logic_error);
  BOOST_TEST(largest_eigenpairs(product_with(a), 1).values.at(0) == fixed_chain_k0(200), tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(the_seed_decides_the_bytes) {
  const SparseMatrix a = fixed_chain(300);
  const auto solve = [&](std::uint64_t seed) {
    return largest_eigenpairs(product_with(a), 2, {.seed = seed});
  };
  const SymmetricEigenpairs one = solve(5), again = solve(5), other = solve(6);
  BOOST_TEST((one.values == again.values && one.vectors == again.vectors && one.products == again.products));
  BOOST_TEST((one.vectors != other.vectors));
  BOOST_TEST(one.values[1] == other.values[1], tolerance(1e-10));
}

BOOST_AUTO_TEST_CASE(the_stiffest_mode_lies_between_its_two_numbers) {
  for (const int n : {1, 2, 3, 10, 40})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) BOOST_TEST_CONTEXT(n << " unknowns, seed " << seed) {
        const RandomPencil pencil(n, seed);
        const StructuralMatrices s = prepare(sparse(pencil.k), sparse(pencil.m));
        const StiffestMode mode = stiffest_mode(s);
        check_encloses(mode, pencil.k0);
        if (n > 1) BOOST_TEST((mode.bound_kind == BoundKind::inertia));
        BOOST_TEST(!mode.indefinite);
        BOOST_TEST(mode.smallest.value() > 0);
        BOOST_TEST((n == 1 ? mode.smallest.value() == mode.value : mode.smallest.value() < mode.value));

        // Padded with soft modes, the same pencil goes through ARPACK.
        const StiffestMode iterated =
            stiffest_mode(prepare(direct_sum(s.stiffness, 0.1 * pencil.k0 / 4 * fixed_chain(200)),
                                  direct_sum(s.mass, diagonal(Vector::Ones(200)))));
        BOOST_TEST(iterated.products > 0);
        check_encloses(iterated, pencil.k0);
        BOOST_TEST(iterated.value == mode.value, tolerance(1e-11));
      }
}

// A proof may fail close above k0, but must never succeed at or below it, not even within the rounding.
BOOST_AUTO_TEST_CASE(is_below_proves_no_more_than_what_is_true) {
  int proved_close = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      const int n = 1 + static_cast<int>(seed % 17);
      const RandomPencil pencil(n, seed);
      const StructuralMatrices s = prepare(sparse(pencil.k), sparse(pencil.m));
      for (const double above : {1e-9, 1e-3, 1.0, 1e6}) BOOST_TEST(is_below(s, pencil.k0 * (1 + above)));
      for (const double below : {1e-15, 1e-14, 1e-12, 1e-9, 1e-3, 1.0, 2.0})
        BOOST_TEST(!is_below(s, pencil.k0 * (1 - below)));
      proved_close += is_below(s, pencil.k0 * (1 + 1e-11));
    }
  BOOST_TEST(proved_close > 50);

  // Mikota's chain in integers: k0 is scale·n² to the last bit, and only rounding could prove it to be
  // smaller.
  double least_multiple = 1;
  for (int n = 1; n <= 20; ++n) {
    least_multiple = static_cast<double>(std::lcm(static_cast<long>(least_multiple), static_cast<long>(n)));
    std::vector<Link> links;
    Vector weight(n);
    for (int i = 0; i < n; ++i) {
      links.push_back({i - 1, i, least_multiple * (n - i)});
      weight[i] = least_multiple / (i + 1);
    }
    for (int scale = 1; scale <= 20; ++scale) {
      const StructuralMatrices s = prepare(scale * stiffness(n, links), diagonal(weight));
      BOOST_TEST(!is_below(s, scale * n * n), n << " masses, scale " << scale);
      BOOST_TEST(is_below(s, scale * n * n * (1 + 1e-11)), n << " masses, scale " << scale);
    }
  }
  const StructuralMatrices zero = prepare(SparseMatrix(3, 3));
  BOOST_TEST(is_below(zero, 1e-300));
  BOOST_TEST(!is_below(zero, 0));
  BOOST_TEST(!is_below(zero, -1));
  BOOST_TEST(!is_below(zero, nan_value));
}

// The factor of one proof tells the next how much rounding to allow for, which is then taken off, not added.
BOOST_AUTO_TEST_CASE(a_proof_after_another_proves_no_more_than_alone) {
  for (const int n : {5, 20, 60}) BOOST_TEST_CONTEXT(n << " unknowns") {
      const RandomPencil pencil(n, 5);
      DefinitenessProof proof(prepare(sparse(pencil.k), sparse(pencil.m)));
      BOOST_TEST(proof.holds(pencil.k0 * (1 + 1e-9), 0, 1));
      for (const double below : {1e-15, 1e-14, 1e-13})
        BOOST_TEST(!proof.holds(pencil.k0 * (1 - below), 0, 1));
    }
}

// Gershgorin's discs of a ring end at k0 itself, so that only rounding could prove k0 to be smaller.
BOOST_AUTO_TEST_CASE(discs_that_end_at_k0_prove_nothing_there) {
  std::vector<Link> ring;
  for (int i = 0; i < 8; ++i) ring.push_back({i, (i + 1) % 8, 1});
  for (const double scale : {1.0, 1.0 / 3, 1e9 / 7}) {
    const StructuralMatrices s = prepare(scale * stiffness(8, ring));
    for (const double below : {0.0, eps / 2, 2 * eps}) BOOST_TEST(!is_below(s, 4 * scale * (1 - below)));
    BOOST_TEST(is_below(s, 4 * scale * (1 + 1e-11)));
  }
}

// K = [[a, -1, -ε ...], [-1, a, -ε ...], ..., 4ε on the diagonal]: adding its ε to 1 + a leaves 1 + a, so
// that the first rows seem to be dominated by a > 1. But with x = (1, 1, ½, ½, ...)
// xᵀKx = 2 (a - 1) - n ε < 0.
BOOST_AUTO_TEST_CASE(small_entries_that_a_sum_loses_are_counted) {
  const int n = 500;
  const double small = 0.75 * eps, a = 1 + 150 * eps;
  BOOST_TEST(1 + a + small == 1 + a);
  BOOST_TEST(2 * (a - 1) - n * small < 0);
  std::vector<Eigen::Triplet<double>> entries{{0, 0, a}, {1, 1, a}, {0, 1, -1}, {1, 0, -1}};
  for (int j = 2; j < n + 2; ++j) {
    entries.emplace_back(j, j, 4 * small);
    for (const int i : {0, 1}) entries.emplace_back(i, j, -small), entries.emplace_back(j, i, -small);
  }
  SparseMatrix k(n + 2, n + 2);
  k.setFromTriplets(entries.begin(), entries.end());
  BOOST_TEST(!DefinitenessProof(prepare(k)).holds(0, 0, -1));
}

BOOST_AUTO_TEST_CASE(a_structure_that_buckles_is_called_indefinite) {
  for (const int n : {20, 300}) {  // dense and by ARPACK
    SparseMatrix one(n, n);
    one.setIdentity();
    const auto mode = [&](double shift) { return stiffest_mode(prepare(fixed_chain(n) - shift * one)); };
    const double smallest = 4 * std::pow(std::sin(pi / (2 * (n + 1))), 2);
    BOOST_TEST(!mode(0).indefinite);
    BOOST_TEST(!mode(smallest).indefinite);         // singular
    BOOST_TEST(!mode(smallest + 1e-9).indefinite);  // within 1e-9 k0
    BOOST_TEST(mode(smallest + 1e-8).indefinite);
    BOOST_TEST(mode(3).indefinite);
    BOOST_TEST(!stiffest_mode(prepare(chain(n, false, false))).indefinite);  // a rigid mode
  }
}

BOOST_AUTO_TEST_CASE(small_and_empty_structures_have_a_stiffest_mode) {
  const StiffestMode single = stiffest_mode(prepare(sparse(Dense{{6}}), sparse(Dense{{1.5}})));
  check_encloses(single, 4);
  BOOST_TEST(single.smallest.value() == 4, tolerance(1e-15));
  for (const int n : {1, 5, 200}) {
    const StiffestMode none = stiffest_mode(prepare(SparseMatrix(n, n)));
    BOOST_TEST(none.converged);
    BOOST_TEST(none.value == 0);
    BOOST_TEST(none.upper_bound == 0);
    BOOST_TEST(!none.indefinite);
    for (const Method& method : all_methods())
      BOOST_TEST((method_limits(method.name(), none, {}, 1.5).status == LimitStatus::unlimited));
  }
}

BOOST_AUTO_TEST_CASE(real_structures_have_the_k0_that_others_computed) {
  for (const auto& problem : problems()) BOOST_TEST_CONTEXT(problem.at("problem")) {
      const std::string name = problem.at("problem");
      if (name == "nlevp_hospital") {
        const auto refuses = [](const std::invalid_argument& error) {
          return std::string(error.what()).find("the stiffness matrix is not symmetric") != std::string::npos;
        };
        BOOST_CHECK_EXCEPTION(load(problem), std::invalid_argument, refuses);
        continue;
      }
      const double k0 = std::stod(problem.at("k0").get<std::string>());
      const StructuralMatrices s = load(problem);
      BOOST_TEST(s.condensed == (name == "bcsst01" ? 24 : name == "nlevp_shaft" ? 201 : 0));
      BOOST_TEST(s.size() + s.condensed == problem.at("n").get<int>());
      const StiffestMode mode = stiffest_mode(s);
      check_encloses(mode, k0, 1e-11);
      BOOST_TEST((mode.bound_kind == BoundKind::inertia));
      BOOST_TEST(!mode.indefinite);
      if (mode.smallest && s.condensed == 0 && name != "nastran_beam10")
        BOOST_TEST(*mode.smallest == std::stod(problem.at("kmin").get<std::string>()),
                   tolerance(100 * eps * k0 / *mode.smallest));

      const double h0 = 1 / std::sqrt(k0);
      for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
          if (method.info().linearized) continue;  // on a linear system, its own explicit method
          const MethodLimits undamped = method_limits(method.name(), mode, {}, 1.5);
          const RegionConstants& region = stability_region(method.name()).constants();
          if (region.covers_quadrant) {
            BOOST_TEST((undamped.status == LimitStatus::unlimited));
            BOOST_TEST((undamped.h_max == infinity && undamped.h_certified == infinity));
            BOOST_TEST(!undamped.recommended);
          } else if (region.imaginary_interval == 0) {
            BOOST_TEST((undamped.status == LimitStatus::none));
            BOOST_TEST((!undamped.h_max && !undamped.h_certified && !undamped.recommended));
          } else {
            BOOST_TEST((undamped.status == LimitStatus::limited));
            BOOST_TEST(undamped.h_max.value() == region.imaginary_interval * h0, tolerance(1e-8));
            BOOST_TEST(undamped.h_certified.value() <= *undamped.h_max);
            BOOST_TEST(undamped.h_certified.value() >= (1 - 1e-6) * *undamped.h_max);
            BOOST_TEST(*undamped.h_certified < region.imaginary_interval * h0);  // proved for the true k0
            BOOST_TEST(undamped.recommended.value() == *undamped.h_max / std::sqrt(1.5), tolerance(1e-9));
          }
          if (std::isfinite(region.y_max))
            BOOST_TEST(undamped.designed.value().h_max == std::sqrt(region.y_max) * h0, tolerance(1e-8));

          DampingModel designed = rayleigh(0.05 / h0, 0);
          designed.kind = DampingModel::Kind::designed;
          std::vector<DampingModel> dampings{designed};
          if (name == "bcsst01")  // the others would only repeat it in their own units
            for (const auto& [d0, alpha] :
                 {std::pair{0.05, 0.0}, {3.0, 0.0}, {0.0, 0.02}, {0.0, 5.0}, {0.05, 0.3}})
              dampings.push_back(rayleigh(d0 / h0, alpha * h0));
          for (const DampingModel& damping : dampings) {
            const MethodLimits limits = method_limits(method.name(), mode, damping, 1.5);
            BOOST_TEST_CONTEXT("d0 " << damping.d0 << " alpha " << damping.alpha) {
              BOOST_TEST(limits.h_max.has_value() == (limits.status != LimitStatus::none));
              BOOST_TEST((limits.status == LimitStatus::unlimited) == region.covers_quadrant);
              if (!limits.h_max) continue;
              BOOST_TEST(limits.h_certified.value() <= *limits.h_max);
              // Rayleigh damping is certified for every k below k0, the limit is for those from k_min on.
              const double least = damping.kind == DampingModel::Kind::rayleigh ? 0.5 : 1 - 1e-6;
              BOOST_TEST(limits.h_certified.value() >= least * *limits.h_max);
              if (limits.status == LimitStatus::limited)
                BOOST_TEST(limits.recommended.value() <= *limits.h_max);
            }
          }
        }
    }
}

// The values of the symmetric driver mapped through the methods, against eigenvalues in 40 digits of the
// whole damped system. D is d0 I + alpha K to 1.2e-7.
BOOST_AUTO_TEST_CASE(limits_with_rayleigh_damping_are_those_of_the_hospital_building) {
  StiffestMode mode = exactly(8045.00001646865349);
  mode.smallest = 27.419997222627919;
  const DampingModel damping = rayleigh(0.49471888, 0.00105345);
  const std::pair<const char*, double> known[] = {
      {"explicit-euler", 0.0011149461183252914}, {"rk2", 0.00891935463676813}, {"rk4", 0.0324414616286668}};
  for (const auto& [method, h_max] : known) BOOST_TEST_CONTEXT(method) {
      BOOST_TEST(method_limits(method, mode, damping, 1.5).h_max.value() == h_max, tolerance(5e-6));
    }
}

// Drag on a soft mode: μ is almost -d0 there, and nearer to zero on the stiffest mode.
BOOST_AUTO_TEST_CASE(the_softest_mode_may_be_the_one_that_limits) {
  StiffestMode k0 = exactly(4);
  k0.smallest = 1e-9;
  const MethodLimits limits = method_limits("explicit-euler", k0, rayleigh(10, 1e-3), 1.5);
  BOOST_TEST(limits.h_max.value() == 2.0 / 10, tolerance(1e-9));
  k0.smallest = k0.value;
  const MethodLimits stiff = method_limits("explicit-euler", k0, rayleigh(10, 1e-3), 1.5);
  BOOST_TEST(stiff.h_max.value() > 1.01 * 2.0 / 10);
}

BOOST_AUTO_TEST_CASE(damping_is_rayleigh_exactly_when_it_is) {
  using Kind = DampingModel::Kind;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Dense m = random.definite(8), k = 1e6 * random.definite(8);
      const auto classify = [&](const Dense& d) {
        return classify_damping(prepare(sparse(k), sparse(m), sparse(d)));
      };
      for (const auto& [d0, alpha] :
           {std::pair{0.3, 2e-4}, {0.0, 1e-3}, {40.0, 0.0}, {1e-5, 1e3}, {1e9, 1e-9}}) {
        const DampingModel found = classify(d0 * m + alpha * k);
        BOOST_TEST((found.kind == Kind::rayleigh));
        BOOST_TEST(found.semidefinite);
        // Each is as accurate as its share of D.
        const double size = (d0 * m + alpha * k).norm();
        BOOST_TEST(std::abs(found.d0 - d0) * m.norm() <= 1e-12 * size);
        BOOST_TEST(std::abs(found.alpha - alpha) * k.norm() <= 1e-12 * size);
        BOOST_TEST((found.d0 >= 0 && found.alpha >= 0));
        Dense off = d0 * m + alpha * k;
        off(2, 2) += 1e-10 * size;
        BOOST_TEST((classify(off).kind == Kind::general));
      }
      BOOST_TEST((classify(m - 1e-7 * k).kind == Kind::general));
      BOOST_TEST((classify(1e-6 * k - 0.01 * m).kind == Kind::general));
      const DampingModel other = classify(random.definite(8));
      BOOST_TEST((other.kind == Kind::general));
      BOOST_TEST(other.semidefinite);
      Dense indefinite = random.definite(8);
      indefinite(3, 3) = -1;
      BOOST_TEST(!classify(indefinite).semidefinite);
      const Vector direction = random.matrix(8, 1);
      BOOST_TEST(classify(direction * direction.transpose()).semidefinite);  // one damper
    }
  // What is light or soft counts like the rest.
  const auto diagonal = [](double a, double b) { return sparse(Dense{{a, 0}, {0, b}}); };
  const SparseMatrix heavy = diagonal(1e14, 1), light = diagonal(1, 1e-14);
  BOOST_TEST((classify_damping(prepare(heavy, heavy, diagonal(1e14, 0))).kind == Kind::general));
  BOOST_TEST((classify_damping(prepare(light, light, diagonal(1, 8e-14))).kind == Kind::general));
  BOOST_TEST((classify_damping(prepare(heavy, diagonal(1, 1), diagonal(1e14, 0.5))).kind == Kind::general));
  BOOST_TEST(!classify_damping(prepare(light, light, diagonal(1, -9e-13))).semidefinite);
  for (const SparseMatrix& mass : {heavy, light}) {
    const DampingModel both =
        classify_damping(prepare(diagonal(1e7, 3), mass, 0.2 * mass + 0.1 * diagonal(1e7, 3)));
    BOOST_TEST((both.kind == Kind::rayleigh));
    BOOST_TEST(both.d0 == 0.2, tolerance(1e-8));  // 2e-7 of D or more
    BOOST_TEST(both.alpha == 0.1, tolerance(1e-8));
  }
  BOOST_TEST(stiffest_mode(prepare(diagonal(1e12, -900))).indefinite);
  BOOST_TEST(stiffest_mode(prepare(diagonal(0, -1))).indefinite);
  BOOST_TEST(!stiffest_mode(prepare(diagonal(1e12, 0))).indefinite);

  const SparseMatrix one = sparse(Dense::Identity(3, 3));
  BOOST_TEST((classify_damping(prepare(one)).kind == Kind::none));
  const DampingModel proportional =
      classify_damping(prepare(4 * one, one, 2 * one));  // K and M do not differ
  BOOST_TEST((proportional.kind == Kind::rayleigh));
  BOOST_TEST(proportional.d0 + 4 * proportional.alpha == 2, tolerance(1e-14));
  const DampingModel free = classify_damping(prepare(SparseMatrix(3, 3), one, 2 * one));
  BOOST_TEST((free.kind == Kind::rayleigh && free.alpha == 0));
  BOOST_TEST(free.d0 == 2, tolerance(1e-14));
}

BOOST_AUTO_TEST_CASE(general_damping_is_known_to_be_harmless_or_unknown) {
  DampingModel general{DampingModel::Kind::general, 0, 0, true}, negative = general;
  negative.semidefinite = false;
  StiffestMode buckling = exactly(100);
  buckling.indefinite = true;
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      const MethodLimits limits = method_limits(method.name(), exactly(100), general, 1.5);
      if (method.name() == "implicit-euler") {
        BOOST_TEST((limits.status == LimitStatus::unlimited));
        BOOST_TEST((limits.h_max == infinity && limits.h_certified == infinity));
      } else {
        BOOST_TEST((limits.status == LimitStatus::unknown));
        BOOST_TEST((!limits.h_max && !limits.h_certified && !limits.recommended));
      }
      for (const MethodLimits& nothing : {method_limits(method.name(), exactly(100), negative, 1.5),
                                          method_limits(method.name(), buckling, general, 1.5)}) {
        BOOST_TEST((nothing.status == LimitStatus::unknown));
        BOOST_TEST((!nothing.h_max && !nothing.h_certified));
      }
    }
}

BOOST_AUTO_TEST_CASE(a_step_is_certified_by_the_bound_on_k0_and_by_nothing_else) {
  StiffestMode mode = exactly(100), buckling = mode;
  mode.upper_bound = 121;
  buckling.indefinite = true;
  DampingModel designed = rayleigh(0, 0);
  designed.kind = DampingModel::Kind::designed;
  for (const Method& method : all_methods()) BOOST_TEST_CONTEXT(method.name()) {
      for (const DampingModel& damping : {DampingModel{}, designed}) {
        const MethodLimits limits = method_limits(method.name(), mode, damping, 1.5);
        if (limits.status == LimitStatus::limited)
          BOOST_TEST(*limits.h_max / limits.h_certified.value() == 1.1, tolerance(1e-10));
        BOOST_TEST(limits.h_certified.has_value() == limits.h_max.has_value());
      }
      for (const DampingModel& damping : {DampingModel{}, designed, rayleigh(0.1, 0.1)}) {
        BOOST_TEST(!method_limits(method.name(), buckling, damping, 1.5).h_certified);
        StiffestMode unproved = mode;
        unproved.upper_bound = infinity;
        const MethodLimits limits = method_limits(method.name(), unproved, damping, 1.5);
        BOOST_TEST(!limits.h_certified);
        BOOST_TEST((limits.h_max == method_limits(method.name(), mode, damping, 1.5).h_max));
      }
    }
}

// ARPACK on the state transition matrix itself, one step of the method's own code per product, against the
// modes of K' mapped through the same method one by one.
BOOST_AUTO_TEST_CASE(the_transition_matrix_has_the_spectral_radius_of_its_modes) {
  const RayleighDamping damping{0.8, 4e-4};
  for (const auto& [rows, columns] : {std::pair{3, 3}, {6, 5}}) {
    Scene scene = stretched_cloth(rows, columns, damping);
    BlockLinearSystem system = stretched(scene);
    system.solver.tolerance = 1e-13;
    const StructuralMatrices matrices = matrices_of(system);
    const Vector root = matrices.mass.diagonal().cwiseSqrt().cwiseInverse();
    const Dense s = root.asDiagonal() * Dense(matrices.stiffness) * root.asDiagonal();
    const Vector squares = Eigen::SelfAdjointEigenSolver<Dense>(s).eigenvalues();
    BOOST_TEST(squares[0] > 1);
    const StiffestMode k0 = stiffest_mode(matrices);
    check_encloses(k0, squares[squares.size() - 1]);

    for (const Method& method : all_methods()) {
      const MethodLimits limits = method_limits(method.name(), k0, rayleigh(damping.d0, damping.alpha), 1.5);
      const bool limited = limits.status == LimitStatus::limited;
      BOOST_TEST(limited == !method.info().implicit);
      const double h_max = limited ? *limits.h_max : 1e-3;
      for (const double part : {0.3, 0.9, 1.02, 1.3}) {
        const double h = part * h_max;
        BOOST_TEST_CONTEXT(method.name()
                           << ", " << rows << " x " << columns << ", h = " << part << " h_max") {
          const bool above = limited && part > 1;
          if (!above && rows > 3) continue;  // the slow modes cluster near 1: small systems only
          const LinearOperator a = transition_operator(system, method.name(), h);
          BOOST_TEST(a.size == 2 * system.size());
          const Eigenvalues found =
              dominant_eigenvalues(a, 2, {.tolerance = 1e-12, .basis_size = rows > 3 ? 100 : 36});
          BOOST_REQUIRE(found.converged);
          const double expected = modal_radius(method.name(), squares, damping, h);
          BOOST_TEST(std::abs(found.values[0]) == expected, tolerance(1e-8));
          BOOST_TEST((expected > 1) == above);
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(a_step_that_fails_inside_the_transition_matrix_is_an_error) {
  Scene scene = stretched_cloth(3, 3, {});
  BlockLinearSystem system = stretched(scene);
  BOOST_CHECK_THROW(transition_operator(system, "explicit-midpoint", 0.1), std::invalid_argument);
  system.solver.max_iterations = 1;
  const LinearOperator a = transition_operator(system, "implicit-euler", 1e-3);
  BOOST_CHECK_THROW(dominant_eigenvalues(a, 1), std::runtime_error);
}

// A ring of m blocks of b unknowns: each row has 1/b in its own block and in the next. Its eigenvalues are
// 1 + exp(2πij/m) and zeros, so the largest is 2 and its neighbours come within 1e-3 of it.
BOOST_AUTO_TEST_CASE(a_neighbour_of_the_largest_eigenvalue_is_not_taken_for_it) {
  for (const auto& [m, b] : {std::pair{64, 7}, {60, 8}, {90, 5}}) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < m; ++i)
      for (const int j : {i, (i + 1) % m})
        for (int p = 0; p < b; ++p)
          for (int q = 0; q < b; ++q) entries.emplace_back(i * b + p, j * b + q, 1.0 / b);
    SparseMatrix k(m * b, m * b);
    k.setFromTriplets(entries.begin(), entries.end());
    const StructuralMatrices s = prepare_nonsymmetric(k);
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const StiffestMode mode = estimated_stiffest_mode(s, {.seed = seed});
      BOOST_TEST((!mode.converged || std::abs(mode.value - 2) < 1e-8), m << ", " << b << ", " << seed);
      BOOST_TEST(mode.converged);
    }
  }
}

// Entries of 2^63 that cancel leave a residual of the size of what they leave.
BOOST_AUTO_TEST_CASE(a_residual_as_large_as_the_value_is_no_convergence) {
  const double big = std::ldexp(1.0, 63);
  SparseMatrix k(3, 3);
  for (const auto& [i, j, value] : std::vector<std::tuple<int, int, double>>{
           {0, 0, big}, {0, 1, big}, {1, 0, -big}, {1, 1, -big}, {0, 2, big / 3}, {2, 2, 1}, {2, 0, 0.1}})
    k.insert(i, j) = value;
  const StiffestMode mode = estimated_stiffest_mode(prepare_nonsymmetric(k));
  BOOST_TEST((!mode.converged || mode.residual <= 1e-6 * mode.value));
}

BOOST_AUTO_TEST_SUITE_END()
