// The laws of the triangle cloth: what its energies are, that forces are differenced energies and stiffness
// matrices differenced forces, what is positive semidefinite, what damping does; and which triangles and
// hinges a grid and a mesh have, where these lie in the cloth at rest, and what is refused.
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "solvers/io/input_error.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/scene/bending.h"
#include "solvers/scene/condition_damping.h"
#include "solvers/scene/triangle_cloth.h"
#include "tests/dense.h"
#include "tests/meshes.h"
#include "tests/refusals.h"

BOOST_AUTO_TEST_SUITE(cloth_energies)

using namespace springstab;
using springstab::test::expect_error;
using springstab::test::faces_of;
using springstab::test::make_mesh;
using springstab::test::smallest_eigenvalue;

namespace {

using boost::test_tools::tolerance;
using Dense = Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector = Eigen::VectorXd;
using Positions = std::vector<Vector3d>;

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double pi = 3.14159265358979323846;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  Vector vector(Eigen::Index size, double scale = 1) {
    Vector v(size);
    for (double& entry : v) entry = (*this)(-scale, scale);
    return v;
  }
  Vector3d point(double scale) { return vector(3, scale); }
  bool coin() { return (*this)(0, 1) < 0.5; }

 private:
  std::mt19937_64 engine_;
};

constexpr double spacing = 0.1;
constexpr int rows = 4, columns = 5;

/// A sheet in the xz-plane of 24 triangles of unequal shapes (more than a batch, less than two), wound at
/// random.
Mesh sheet(Random& random) {
  Positions vertices;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      vertices.emplace_back(spacing * (j + random(-0.2, 0.2)), 0, spacing * (i + random(-0.2, 0.2)));
  std::vector<std::vector<int>> faces;
  for (int i = 0; i + 1 < rows; ++i)
    for (int j = 0; j + 1 < columns; ++j) {
      const int p = i * columns + j, q = p + columns;
      if (random.coin()) {
        faces.push_back({p, p + 1, q + 1});
        faces.push_back({p, q + 1, q});
      } else {
        faces.push_back({p, p + 1, q});
        faces.push_back({p + 1, q + 1, q});
      }
    }
  for (auto& face : faces) {
    std::rotate(face.begin(), face.begin() + static_cast<int>(random(0, 3)), face.end());
    if (random.coin()) std::reverse(face.begin(), face.end());
  }
  return make_mesh(vertices, faces);
}

const ClothMaterial material{.stiffness = {900, 700, 150, 2e-3}, .damping = {0.5, 0.7, 0.3, 4e-5}};

struct Pose {
  std::string name;
  Positions x;
};

std::vector<Pose> poses(const Positions& rest, Random& random) {
  const auto moved = [&](double noise, const std::function<Vector3d(const Vector3d&)>& map) {
    Positions x;
    for (const Vector3d& p : rest) x.push_back(map(p) + random.point(noise * spacing));
    return x;
  };
  const auto folded = [&](double angle) {  // behind the second row, lest triangles lose their height
    const double crease = 1.1 * spacing;
    return moved(0.02, [&](const Vector3d& p) -> Vector3d {
      const double beyond = std::max(p.z() - crease, 0.0);
      return {p.x(), beyond * std::sin(angle), std::min(p.z(), crease) + beyond * std::cos(angle)};
    });
  };
  std::vector<Pose> all{
      {"rest", rest},
      {"random", moved(0.3, [](const Vector3d& p) { return p; })},
      {"stretched", moved(0, [](const Vector3d& p) { return Vector3d(1.7 * p.x(), 0, 1.2 * p.z()); })},
      {"compressed", moved(0.02, [](const Vector3d& p) { return Vector3d(0.6 * p); })},
      {"sheared", moved(0.02, [](const Vector3d& p) { return Vector3d(p.x() + 0.7 * p.z(), 0, p.z()); })},
      {"folded up", folded(pi - 0.05)},
      {"folded down", folded(0.05 - pi)},
      {"nearly flat", moved(1e-6, [](const Vector3d& p) { return p; })},
      {"inverted", moved(0.05, [](const Vector3d& p) { return p; })}};
  all.back().x[columns + 1] += Vector3d(1.6 * spacing, 0, 0);  // an inner particle across its neighbour
  return all;
}

/// A cloth in a scene's numbers, some of its particles pinned.
struct Model {
  TriangleCloth cloth;  // in the scene's numbers
  int free_count;
  std::vector<int> number;

  Model(TriangleCloth original, const std::vector<int>& pinned = {})
      : cloth(std::move(original)), free_count(static_cast<int>(cloth.rest.size() - pinned.size())) {
    int next_free = 0, next_pinned = free_count;
    for (int i = 0; i < static_cast<int>(cloth.rest.size()); ++i)
      number.push_back(std::ranges::count(pinned, i) ? next_pinned++ : next_free++);
    for (RestTriangle& t : cloth.triangles)
      for (int& p : t.particles) p = number[p];
    for (Hinge& h : cloth.hinges)
      for (int& p : h.particles) p = number[p];
  }

  StretchShear stretch_shear() const {
    return {triangles(), cloth.material.stiffness.in_plane(), cloth.material.rest_stretch};
  }
  Bending bending() const { return {hinges(), cloth.material.stiffness.bending}; }
  StretchShearDamping stretch_shear_damping() const {
    return {triangles(), cloth.material.damping.in_plane()};
  }
  BendingDamping bending_damping() const { return {hinges(), cloth.material.damping.bending}; }

  /// All coordinates in the scene's order.
  Vector coordinates(const Positions& x) const {
    Vector all(3 * static_cast<Eigen::Index>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i) all.segment<3>(3 * number[i]) = x[i];
    return all;
  }
  ParticleField field(const Vector& all) const {
    return {all.data(), all.data() + 3 * free_count, free_count};
  }

  Vector force(const ElasticTerm& term, const Vector& x) const {
    Vector f = Vector::Zero(3 * free_count);
    term.add_force(field(x), f.data());
    return f;
  }
  Vector force(const DampingTerm& term, const Vector& x, const Vector& v) const {
    Vector f = Vector::Zero(3 * free_count);
    term.add_force(field(x), field(v), f.data());
    return f;
  }
  double energy(const ElasticTerm& term, const Vector& x) const { return term.energy(field(x)); }

  template <class Term>
  Dense stiffness(const Term& term, const Vector& x) const {
    BlockSparseMatrix matrix(free_count, term.couplings());
    term.add_stiffness(field(x), matrix);
    return Dense(matrix.to_sparse());
  }
  template <class Term>
  Dense projected(const Term& term, const Vector& x) const {
    BlockSparseMatrix matrix(free_count, term.couplings());
    term.add_projected_stiffness(field(x), matrix);
    return Dense(matrix.to_sparse());
  }
  Dense damping(const DampingTerm& term, const Vector& x) const {
    BlockSparseMatrix matrix(free_count, term.couplings());
    term.add_damping(field(x), matrix);
    return Dense(matrix.to_sparse());
  }

 private:
  std::shared_ptr<const TriangleConditions> triangles() const {
    return std::make_shared<TriangleConditions>(cloth.triangles, cloth.material.scaling, free_count);
  }
  std::shared_ptr<const HingeAngles> hinges() const {
    return std::make_shared<HingeAngles>(cloth.hinges, free_count);
  }
};

ClothMaterial with(AreaScaling scaling) {
  ClothMaterial other = material;
  other.scaling = scaling;
  if (scaling == AreaScaling::original)  // triangles have about half a cell's area
    for (double PerCondition::*k :
         {&PerCondition::stretch_u, &PerCondition::stretch_v, &PerCondition::shear}) {
      other.stiffness.*k /= spacing * spacing / 2;
      other.damping.*k /= spacing * spacing / 2;
    }
  return other;
}

const std::vector<int> some_pins{1, 4, 11};

void for_each_pose(const std::function<void(const Model&, const Pose&, Random&)>& visit,
                   const std::vector<int>& pinned = {}) {
  for (const std::uint64_t seed : {1u, 2u})
    for (const AreaScaling scaling : {AreaScaling::continuum, AreaScaling::original}) {
      Random random(seed);
      const Mesh mesh = sheet(random);
      const Model model(make_cloth(mesh, with(scaling)), pinned);
      for (const Pose& pose : poses(mesh.vertices, random))
        BOOST_TEST_CONTEXT("seed " << seed << (scaling == AreaScaling::original ? ", original, " : ", ")
                                   << pose.name) {
          visit(model, pose, random);
        }
    }
}

template <class Term>
constexpr bool is_bending(const Term&) {
  return std::is_same_v<Term, Bending>;
}

/// Visits the two elastic terms.
template <class Visit>
void for_each_term(const Model& model, const Visit& visit) {
  BOOST_TEST_CONTEXT("stretch and shear") { visit(model.stretch_shear()); }
  BOOST_TEST_CONTEXT("bending") { visit(model.bending()); }
}

/// The derivatives along each of the first `count` coordinates by central differences of two steps,
/// extrapolated to fourth order (Richardson).
Dense differenced(const std::function<Vector(const Vector&)>& f, const Vector& x, Eigen::Index count,
                  double step) {
  const auto central = [&](Eigen::Index j, double h) -> Vector {
    const Vector u = h * Vector::Unit(x.size(), j);
    return (f(x + u) - f(x - u)) / (2 * h);
  };
  Dense jacobian(f(x).size(), count);
  for (Eigen::Index j = 0; j < count; ++j)
    jacobian.col(j) = (4 * central(j, step / 2) - central(j, step)) / 3;
  return jacobian;
}

// Relative to the smallest height of a triangle, about 0.05 spacing in the random and the inverted pose, a
// step of 2e-4 spacing is 4e-3: its fourth power 2.6e-10 is the truncation, times a factor for the fifth
// derivative; rounding is eps / 2e-3 (the energy is about the gradient times the spacing, and so on). Near
// rest and flat the numbers are small but so are their rounding errors.
constexpr double step = 2e-4 * spacing, difference_tolerance = 1e-8;

void check_equal(const Dense& found, const Dense& expected, double relative) {
  BOOST_REQUIRE_EQUAL(found.rows(), expected.rows());
  BOOST_REQUIRE_EQUAL(found.cols(), expected.cols());
  BOOST_TEST((found - expected).norm() <= relative * expected.norm(),
             "relative difference " << (found - expected).norm() / expected.norm());
}

Vector turned(const Eigen::Matrix3d& turn, const Vector& u) {
  return (turn * u.reshaped(3, u.size() / 3)).reshaped();
}

const Eigen::Matrix3d some_turn(Eigen::AngleAxisd(1.1, Vector3d(0.2, -0.7, 0.4).normalized()));

/// Two triangles at the edge from (0, 0, 0) to (0, 0, l): one in the xz-plane with its apex at x = -a, the
/// other turned out of it by an angle, its apex at the distance b from the edge.
Positions butterfly(double angle, double l = 0.3, double a = 0.2, double b = 0.15) {
  return {{0, 0, 0}, {0, 0, l}, {-a, 0, 0.4 * l}, {b * std::cos(angle), b * std::sin(angle), 0.7 * l}};
}

Model hinge(const std::array<int, 4>& particles, double rest_angle, const Positions& rest, double k) {
  TriangleCloth cloth;
  cloth.rest = rest;
  cloth.hinges = {{particles, rest_angle}};
  cloth.material.stiffness = {0, 0, 0, k};
  cloth.material.damping = {0, 0, 0, k};
  return cloth;
}

Model single_triangle(const std::array<Vector2d, 3>& uv, const ClothMaterial& of) {
  TriangleCloth cloth;
  for (const Vector2d& p : uv) cloth.rest.emplace_back(p.x(), 0, p.y());
  cloth.triangles = {{{0, 1, 2}, uv}};
  cloth.material = of;
  return cloth;
}

}  // namespace

// --- what the energies are ---

BOOST_AUTO_TEST_CASE(an_affine_map_stores_its_closed_form_in_every_triangle) {
  Random random(3);
  for (const AreaScaling scaling : {AreaScaling::continuum, AreaScaling::original})
    for (int trial = 0; trial < 5; ++trial) {
      ClothMaterial m = with(scaling);
      m.rest_stretch = {random(0.8, 1.2), random(0.8, 1.2)};
      const Mesh mesh = sheet(random);
      const Model model(make_cloth(mesh, m));
      const Vector3d fu = random.point(1.5), fv = random.point(1.5), shift = random.point(1);
      Positions x;
      double weight = 0;
      for (const Vector3d& p : mesh.vertices) x.push_back(shift + p.x() * fu + p.z() * fv);
      for (const auto& face : faces_of(mesh)) {
        const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
        const double area = (b - a).cross(c - a).norm() / 2;
        weight += scaling == AreaScaling::continuum ? area : area * area;
      }
      const double expected = weight / 2 *
                              (m.stiffness.stretch_u * std::pow(fu.norm() - m.rest_stretch.u, 2) +
                               m.stiffness.stretch_v * std::pow(fv.norm() - m.rest_stretch.v, 2) +
                               m.stiffness.shear * std::pow(fu.dot(fv), 2));
      BOOST_TEST(model.energy(model.stretch_shear(), model.coordinates(x)) == expected, tolerance(1e-11));
    }
}

// The continuum energy of a stretched sheet is ½ Σ κ C² times its area, however it is divided. The original
// one is proportional to the sum of the squared areas: a quarter for half the spacing.
BOOST_AUTO_TEST_CASE(refining_a_sheet_keeps_its_continuum_energy_and_quarters_the_original_one) {
  const auto energy = [](int cells, AreaScaling scaling) {
    ClothMaterial m = material;
    m.scaling = scaling;
    const Model model(make_cloth(Grid{cells + 1, cells + 1, 1.0 / cells}, m));
    Positions x;
    for (const Vector3d& p : model.cloth.rest) x.emplace_back(1.3 * p.x() + 0.2 * p.z(), 0, 0.9 * p.z());
    return model.energy(model.stretch_shear(), model.coordinates(x));
  };
  const double expected =
      0.5 * (900 * 0.3 * 0.3 + 700 * std::pow(std::hypot(0.2, 0.9) - 1, 2) + 150 * std::pow(1.3 * 0.2, 2));
  for (const int cells : {1, 3, 8})
    BOOST_TEST(energy(cells, AreaScaling::continuum) == expected, tolerance(1e-12));
  BOOST_TEST(energy(3, AreaScaling::original) == expected / 18, tolerance(1e-12));
  BOOST_TEST(energy(6, AreaScaling::original) == expected / 72, tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_fold_stores_half_k_times_its_angle_squared) {
  for (const double angle : {0.0, 1e-9, 0.1, -0.1, 1.3, -pi / 2, 3.0, 3.1415, -3.1415, pi})
    BOOST_TEST_CONTEXT("angle " << angle) {
      const Model model = hinge({0, 1, 2, 3}, 0, butterfly(0), 0.3);
      const double energy = model.energy(model.bending(), model.coordinates(butterfly(angle)));
      // cos and sin of the angle are off by eps, and so is the angle.
      BOOST_TEST(std::abs(energy - 0.15 * angle * angle) <= 0.3 * std::abs(angle) * 8 * eps);
    }
}

BOOST_AUTO_TEST_CASE(a_fold_at_rest_is_measured_from_its_own_angle_the_short_way_round) {
  for (const double rest : {0.5, -2.0, 3.0, pi})
    for (const double angle : {0.0, 0.4, -1.5, 2.9, -3.0})
      BOOST_TEST_CONTEXT("rest " << rest << ", angle " << angle) {
        // a third point out of the plane, lest the mesh lies in one when its fold is shut
        Mesh mesh = make_mesh(butterfly(rest), {{0, 1, 2}, {0, 1, 3}});
        const Model model(make_cloth(mesh, material));
        BOOST_REQUIRE_EQUAL(model.cloth.hinges.size(), 1u);
        BOOST_TEST(std::abs(std::abs(model.cloth.hinges[0].rest_angle) - std::abs(rest)) < 1e-14);
        BOOST_TEST(model.energy(model.bending(), model.coordinates(mesh.vertices)) < 1e-30);
        const double turn = std::remainder(angle - rest, 2 * pi);
        BOOST_TEST(model.energy(model.bending(), model.coordinates(butterfly(angle))) ==
                       0.5 * material.stiffness.bending * turn * turn,
                   tolerance(1e-12));
      }
}

BOOST_AUTO_TEST_CASE(the_force_of_a_fold_drives_it_open_along_the_shorter_way) {
  const Model model = hinge({0, 1, 2, 3}, 0, butterfly(0), 0.3);
  for (const double angle : {0.2, 3.1, -0.2, -3.1}) {
    const Vector f = model.force(model.bending(), model.coordinates(butterfly(angle)));
    const Vector3d tangent(-std::sin(angle), std::cos(angle), 0);
    // the torque k θ about the edge, on the arm b
    BOOST_TEST(f.segment<3>(9).dot(tangent) == -0.3 * angle / 0.15, tolerance(1e-12));
    BOOST_TEST((f.segment<3>(9) - f.segment<3>(9).dot(tangent) * tangent).norm() < 1e-14);
  }
}

// --- derivatives ---

BOOST_AUTO_TEST_CASE(a_force_is_the_differenced_energy) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random&) {
        if (pose.name == "rest") return;
        const Vector x = model.coordinates(pose.x);
        for_each_term(model, [&](const auto& term) {
          const bool flat_bending = pose.name == "stretched" && is_bending(term);
          const Vector f = model.force(term, x);
          if (flat_bending) {
            BOOST_TEST(f.norm() < 1e-13);
            return;
          }
          const auto energy = [&](const Vector& at) { return Vector::Constant(1, model.energy(term, at)); };
          check_equal(f, -differenced(energy, x, f.size(), step).transpose(), difference_tolerance);
          BOOST_TEST(f.norm() > (pose.name == "nearly flat" ? 1e-9 : 1e-3));
        });
      },
      some_pins);
}

BOOST_AUTO_TEST_CASE(the_stiffness_matrix_is_the_differenced_force) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random&) {
        const Vector x = model.coordinates(pose.x);
        for_each_term(model, [&](const auto& term) {
          const Dense k = model.stiffness(term, x);
          const auto f = [&](const Vector& at) { return model.force(term, at); };
          check_equal(k, -differenced(f, x, k.cols(), step), difference_tolerance);
          BOOST_TEST((k == k.transpose()));
          for (Eigen::Index i = 0; i < k.rows(); i += 3) BOOST_TEST((k.block<3, 3>(i, i).norm() > 1e-2));
        });
      },
      some_pins);
}

BOOST_AUTO_TEST_CASE(derivatives_hold_up_to_a_closed_fold) {
  for (const double angle : {3.0, -3.0, pi - 1e-3, 1e-3 - pi, 0.0, 1e-8})
    for (const double rest : {0.0, 0.3}) BOOST_TEST_CONTEXT("angle " << angle << ", rest " << rest) {
        const Model model = hinge({0, 1, 2, 3}, rest, butterfly(0), 0.3);
        const Bending bending = model.bending();
        const Vector x = model.coordinates(butterfly(angle));
        // the step turns the fold by less than 1e-3
        const auto f = [&](const Vector& at) { return model.force(bending, at); };
        const Dense k = model.stiffness(bending, x);
        check_equal(k, -differenced(f, x, 12, step), difference_tolerance);
        BOOST_TEST(k.norm() > 1);
        if (angle - rest == 0 || angle == 1e-8) continue;
        const auto energy = [&](const Vector& at) { return Vector::Constant(1, model.energy(bending, at)); };
        check_equal(f(x), -differenced(energy, x, 12, step).transpose(), difference_tolerance);
        BOOST_TEST(f(x).norm() > 0.1);
      }
}

BOOST_AUTO_TEST_CASE(a_product_with_the_stiffness_needs_no_matrix) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random& random) {
        const Vector x = model.coordinates(pose.x);
        for_each_term(model, [&](const auto& term) {
          const Vector u = random.vector(3 * model.free_count), before = random.vector(u.size());
          Vector out = before;
          term.add_stiffness_times(model.field(x), u.data(), -0.7, out.data());
          const Vector expected = -0.7 * model.stiffness(term, x) * u;
          // `before` of at most 1 leaves its rounding in the difference
          BOOST_TEST((out - before - expected).norm() <= 1e-13 * expected.norm() + 10 * eps * before.norm());
          BOOST_TEST(expected.norm() > 0.1);

          // and the force with damping is the force and such a product
          Vector damped = Vector::Zero(u.size()), apart = damped;
          term.add_damped_force(model.field(x), u.data(), 0.3, damped.data());
          term.add_force(model.field(x), apart.data());
          const double size = apart.norm() + expected.norm();
          term.add_stiffness_times(model.field(x), u.data(), -0.3, apart.data());
          BOOST_TEST((damped - apart).norm() <= 1e-13 * size);
        });
      },
      some_pins);
}

BOOST_AUTO_TEST_CASE(a_bound_matrix_and_any_other_are_filled_alike_and_added_to) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random& random) {
        const Vector x = model.coordinates(pose.x);
        for_each_term(model, [&](auto term) {
          BlockSparseMatrix free(model.free_count, term.couplings());
          term.add_stiffness(model.field(x), free);
          // a pattern that has other blocks too
          Couplings more = term.couplings();
          for (int i = 0; i < 10; ++i)
            more.emplace_back(static_cast<int>(random(0, model.free_count)),
                              static_cast<int>(random(0, model.free_count)));
          BlockSparseMatrix bound(model.free_count, more);
          term.bind(bound.pattern());
          term.add_stiffness(model.field(x), bound);
          const Dense once(bound.to_sparse());
          BOOST_TEST((once == Dense(free.to_sparse())));
          term.add_stiffness(model.field(x), bound);
          check_equal(Dense(bound.to_sparse()), 2 * once, 4 * eps);
          free.set_zero();
          term.add_stiffness(model.field(x), free);
          BOOST_TEST((once == Dense(free.to_sparse())));
        });
      },
      some_pins);
}

// --- symmetries ---

BOOST_AUTO_TEST_CASE(a_free_cloth_exerts_no_force_and_no_torque_on_itself) {
  for_each_pose([](const Model& model, const Pose& pose, Random&) {
    if (pose.name == "rest") return;
    const Vector x = model.coordinates(pose.x);
    for_each_term(model, [&](const auto& term) {
      const Vector f = model.force(term, x);
      Vector3d sum(0, 0, 0), torque(0, 0, 0);
      for (Eigen::Index i = 0; i < f.size(); i += 3) {
        sum += f.segment<3>(i);
        torque += Vector3d(x.segment<3>(i)).cross(Vector3d(f.segment<3>(i)));
      }
      // Of a few hundred element forces that largely cancel, each up to k/height.
      const double size = f.lpNorm<1>() + 1;
      BOOST_TEST(sum.norm() <= 500 * eps * size);
      BOOST_TEST(torque.norm() <= 500 * eps * size);
    });
  });
}

BOOST_AUTO_TEST_CASE(a_moved_and_turned_cloth_has_the_same_energy_and_turned_forces) {
  for_each_pose([](const Model& model, const Pose& pose, Random& random) {
    if (pose.name == "rest" || pose.name == "nearly flat") return;  // nothing but rounding, see below
    const Vector x = model.coordinates(pose.x);
    Vector other = turned(some_turn, x);
    const Vector3d shift = random.point(0.5);
    for (Eigen::Index i = 0; i < other.size(); i += 3) other.segment<3>(i) += shift;
    for_each_term(model, [&](const auto& term) {
      if (pose.name == "stretched" && is_bending(term)) return;
      // Positions of up to 1 are rounded, heights are down to 0.005.
      BOOST_TEST(model.energy(term, other) == model.energy(term, x), tolerance(1e-11));
      check_equal(model.force(term, other), turned(some_turn, model.force(term, x)), 1e-11);
    });
  });
}

BOOST_AUTO_TEST_CASE(there_is_no_energy_and_no_force_at_rest_wherever_that_is) {
  for_each_pose([](const Model& model, const Pose& pose, Random& random) {
    if (pose.name != "rest") return;
    Vector x = turned(some_turn, model.coordinates(pose.x));
    const Vector3d shift = random.point(1);
    for (Eigen::Index i = 0; i < x.size(); i += 3) x.segment<3>(i) += shift;
    // Positions of size 1 rounded by eps change C by eps/0.05 and θ by as much.
    for_each_term(model, [&](const auto& term) {
      BOOST_TEST(model.energy(term, x) >= 0);
      BOOST_TEST(model.energy(term, x) < 1e-24);
      BOOST_TEST(model.force(term, x).norm() < 1e-9);
      BOOST_TEST(model.stiffness(term, x).norm() > 1);
    });
  });
}

BOOST_AUTO_TEST_CASE(how_faces_and_hinges_are_written_changes_nothing) {
  for_each_pose([](const Model& model, const Pose& pose, Random& random) {
    if (pose.name == "rest") return;
    Random again(1);
    std::vector<std::vector<int>> faces;
    for (const RestTriangle& t : model.cloth.triangles) {
      std::vector<int> face(t.particles.begin(), t.particles.end());
      std::rotate(face.begin(), face.begin() + static_cast<int>(random(0, 3)), face.end());
      if (random.coin()) std::reverse(face.begin(), face.end());
      faces.push_back(face);
    }
    const Model other(make_cloth(make_mesh(model.cloth.rest, faces), model.cloth.material));
    Model swapped = model;
    for (Hinge& h : swapped.cloth.hinges) {
      h.rest_angle = 0.4;
      if (random.coin()) std::swap(h.particles[0], h.particles[1]), h.rest_angle *= -1;
      if (random.coin()) std::swap(h.particles[2], h.particles[3]), h.rest_angle *= -1;
    }
    Model bent = model;
    for (Hinge& h : bent.cloth.hinges) h.rest_angle = 0.4;
    const Vector x = model.coordinates(pose.x);
    const double energy = model.energy(model.bending(), x);
    BOOST_TEST(std::abs(other.energy(other.bending(), x) - energy) <= 1e-12 * (energy + 1e-12));
    BOOST_TEST((other.force(other.bending(), x) - model.force(model.bending(), x)).norm() <=
               1e-12 * (1 + model.force(model.bending(), x).norm()));
    BOOST_TEST(other.energy(other.stretch_shear(), x) == model.energy(model.stretch_shear(), x),
               tolerance(pose.name == "nearly flat" ? 1e-8 : 1e-12));
    check_equal(swapped.force(swapped.bending(), x), bent.force(bent.bending(), x), 1e-11);
    check_equal(swapped.stiffness(swapped.bending(), x), bent.stiffness(bent.bending(), x), 1e-11);
    BOOST_TEST(bent.force(bent.bending(), x).norm() > 1e-3);
  });
}

BOOST_AUTO_TEST_CASE(a_pinned_cloth_is_a_part_of_the_free_one) {
  std::map<std::pair<std::string, int>, Vector> forces;
  std::map<std::pair<std::string, int>, Dense> matrices;
  int run = 0;
  const auto remember = [&](const Model& model, const Pose& pose, Random&) {
    if (pose.name == "rest") run = (run + 1) % 4;
    const Vector x = model.coordinates(pose.x);
    const auto key = [&](int term) { return std::make_pair(pose.name, 2 * run + term); };
    forces[key(0)] = model.force(model.stretch_shear(), x);
    forces[key(1)] = model.force(model.bending(), x);
    matrices[key(0)] = model.stiffness(model.stretch_shear(), x);
    matrices[key(1)] = model.stiffness(model.bending(), x);
  };
  for_each_pose(remember);
  const auto free_forces = forces;
  const auto free_matrices = matrices;
  for_each_pose(remember, some_pins);
  std::vector<Eigen::Index> kept;
  for (int i = 0; i < rows * columns; ++i)
    if (!std::ranges::count(some_pins, i))
      for (int r = 0; r < 3; ++r) kept.push_back(3 * i + r);
  BOOST_TEST(forces.size() == 9u * 8u);
  for (const auto& [key, f] : forces) {
    BOOST_REQUIRE_EQUAL(f.size(), 3 * (rows * columns - 3));
    BOOST_TEST((f == free_forces.at(key)(kept)));
    BOOST_TEST((matrices.at(key) == free_matrices.at(key)(kept, kept)));
  }
}

// --- definiteness ---

BOOST_AUTO_TEST_CASE(a_projected_stiffness_is_positive_semidefinite_and_exact_where_that_is) {
  bool indefinite = false;
  for_each_pose([&](const Model& model, const Pose& pose, Random&) {
    const Vector x = model.coordinates(pose.x);
    for_each_term(model, [&](const auto& term) {
      const Dense exact = model.stiffness(term, x), projected = model.projected(term, x);
      BOOST_TEST((projected == projected.transpose()));
      BOOST_TEST(smallest_eigenvalue(projected) >= -1e-14 * projected.norm());
      BOOST_TEST(projected.norm() > 0.1);
      if (pose.name == "rest" || pose.name == "stretched") {
        // At rest the tension is rounding of either sign.
        check_equal(projected, exact, 1e-13);
      } else if (!is_bending(term)) {
        BOOST_TEST(smallest_eigenvalue(projected - exact) >= -1e-13 * exact.norm());
        if (pose.name != "nearly flat") {
          BOOST_TEST((projected - exact).norm() > 1e-3 * exact.norm());
          BOOST_TEST(smallest_eigenvalue(exact) < -1e-4 * exact.norm());
          indefinite = true;
        }
      }
    });
    if (pose.name == "stretched")  // tension holds it out of its plane too
      BOOST_TEST((model.stiffness(model.stretch_shear(), x)(1, 1) > 1));
  });
  BOOST_TEST(indefinite);
}

BOOST_AUTO_TEST_CASE(the_projected_stiffness_of_bending_is_the_gauss_newton_part) {
  for_each_pose([](const Model& model, const Pose& pose, Random&) {
    // The damping of each angle with the stiffness as its coefficient has that matrix.
    Model same = model;
    same.cloth.material.damping.bending = model.cloth.material.stiffness.bending;
    const Vector x = model.coordinates(pose.x);
    BOOST_TEST((model.projected(model.bending(), x) == same.damping(same.bending_damping(), x)));
  });
}

// --- damping ---

BOOST_AUTO_TEST_CASE(damping_takes_energy_from_all_but_rigid_motion) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random& random) {
        const Vector x = model.coordinates(pose.x);
        Vector v = random.vector(x.size());
        v.tail(x.size() - 3 * model.free_count).setZero();
        const StretchShearDamping in_plane = model.stretch_shear_damping();
        const BendingDamping bending = model.bending_damping();
        for (const DampingTerm* term :
             {static_cast<const DampingTerm*>(&in_plane), static_cast<const DampingTerm*>(&bending)}) {
          const Dense c = model.damping(*term, x);
          const auto f = [&](const Vector& at) { return model.force(*term, x, at); };
          // linear in v: any step will do
          check_equal(c, -differenced(f, v, c.cols(), 1), 1e-11);
          BOOST_TEST((c == c.transpose()));
          BOOST_TEST(smallest_eigenvalue(c) >= -1e-14 * c.norm());
          BOOST_TEST(c.norm() > 1e-2);
          const double power = v.head(3 * model.free_count).dot(f(v));
          BOOST_TEST(power < -1e-4);
          BOOST_TEST(power == -v.head(c.rows()).dot(c * v.head(c.rows())), tolerance(1e-11));

          const Vector3d velocity = random.point(1), spin = random.point(1);
          Vector rigid(x.size());
          for (Eigen::Index i = 0; i < x.size(); i += 3)
            rigid.segment<3>(i) = velocity + spin.cross(Vector3d(x.segment<3>(i)));
          BOOST_TEST(f(rigid).norm() <= 1e-12 * c.norm());
          BOOST_TEST(f(v).norm() > 1e-2);
        }
      },
      some_pins);
}

// What a condition's damping dissipates is k_d A (or A²) times the square of the rate at which it changes.
BOOST_AUTO_TEST_CASE(each_condition_is_damped_by_its_own_rate) {
  Random random(5);
  for (const AreaScaling scaling : {AreaScaling::continuum, AreaScaling::original})
    for (int condition = 0; condition < 3; ++condition) {
      const std::array<Vector2d, 3> uv{Vector2d(0.1, 0.2), Vector2d(0.5, 0.3), Vector2d(0.2, 0.7)};
      ClothMaterial m;
      m.scaling = scaling;
      m.damping = {condition == 0 ? 2.0 : 0, condition == 1 ? 2.0 : 0, condition == 2 ? 2.0 : 0, 0};
      const Model model = single_triangle(uv, m);
      const Vector x = random.vector(9), v = random.vector(9);
      const auto value = [&](double t) {
        const Vector at = x + t * v;
        Eigen::Matrix2d rest;
        rest << uv[1] - uv[0], uv[2] - uv[0];
        Eigen::Matrix<double, 3, 2> edges;
        edges << at.segment<3>(3) - at.segment<3>(0), at.segment<3>(6) - at.segment<3>(0);
        const Eigen::Matrix<double, 3, 2> w = edges * rest.inverse();
        return condition == 2 ? w.col(0).dot(w.col(1)) : w.col(condition).norm();
      };
      const double rate = (value(1e-5) - value(-1e-5)) / 2e-5;
      const double area =
          std::abs((uv[1] - uv[0]).x() * (uv[2] - uv[0]).y() - (uv[1] - uv[0]).y() * (uv[2] - uv[0]).x()) / 2;
      const double weight = scaling == AreaScaling::continuum ? area : area * area;
      const double power = v.dot(model.force(model.stretch_shear_damping(), x, v));
      BOOST_TEST(power == -2 * weight * rate * rate, tolerance(1e-7));
      BOOST_TEST(std::abs(rate) > 0.01);
    }
  // The angle of a butterfly that opens at 3 rad/s.
  const Model model = hinge({0, 1, 2, 3}, 0, butterfly(0), 0.3);
  Vector v = Vector::Zero(12);
  v[9] = -3 * 0.15 * std::sin(0.8);
  v[10] = 3 * 0.15 * std::cos(0.8);
  BOOST_TEST(v.dot(model.force(model.bending_damping(), model.coordinates(butterfly(0.8)), v)) == -0.3 * 9,
             tolerance(1e-12));
}

// --- what has no value ---

BOOST_AUTO_TEST_CASE(a_collapsed_triangle_has_no_force) {
  const Model model = hinge({0, 1, 2, 3}, 0, butterfly(0), 0.3);
  const auto finite = [&](const Positions& x) {
    return model.force(model.bending(), model.coordinates(x)).allFinite();
  };
  BOOST_TEST(finite(butterfly(1)));
  BOOST_TEST(finite(butterfly(1, 0.3, 1e-9)));  // thin, not degenerate
  BOOST_TEST(!finite(butterfly(1, 0.3, 0)));
  BOOST_TEST(!finite(butterfly(1, 0.3, 0.2, 0)));
  BOOST_TEST(!finite(butterfly(1, 0)));

  const std::array<Vector2d, 3> uv{Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)};
  const Model triangle = single_triangle(uv, material);
  BOOST_TEST(triangle.force(triangle.stretch_shear(), Vector::LinSpaced(9, 0, 1)).allFinite());
  BOOST_TEST(!triangle.force(triangle.stretch_shear(), Vector::Zero(9)).allFinite());
  BOOST_TEST(!std::isfinite(triangle.energy(triangle.stretch_shear(), Vector::Constant(9, nan_value))));
  BOOST_TEST(!triangle.projected(triangle.stretch_shear(), Vector::Zero(9)).allFinite());
}

// --- the arctangent ---

BOOST_AUTO_TEST_CASE(the_arctangent_is_that_of_the_library_to_four_units) {
  Random random(7);
  double worst = 0;
  const auto compare = [&](double y, double x) {
    const long double expected = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    const auto error = static_cast<double>(std::abs((arctangent(y, x) - expected) / expected));
    worst = std::max(worst, error);
  };
  for (int i = 0; i < 200000; ++i) {
    const double angle = random(-pi, pi), radius = std::exp(random(-300, 300));
    compare(radius * std::sin(angle), radius * std::cos(angle));
    compare(random(-1, 1), std::exp(random(-40, 40)) * (random.coin() ? 1 : -1));
    // around the borders of the octants and of the polynomial
    const double edge = std::round(random(-8, 8)) * pi / 8 + random(-1, 1) * std::exp(random(-37, -2));
    compare(std::sin(edge), std::cos(edge));
  }
  BOOST_TEST(worst <= 4 * eps / 2);
  BOOST_TEST(worst > 0);
  for (const double y : {0.0, -0.0, 1.0, -1.0})
    for (const double x : {1.0, -1.0, 0.0}) {
      if (y == 0 && x == 0) continue;
      BOOST_TEST(arctangent(y, x) == std::atan2(y, x));
      BOOST_TEST(std::signbit(arctangent(y, x)) == std::signbit(y));
    }
  BOOST_TEST(std::isnan(arctangent(0, 0)));
  BOOST_TEST(std::isnan(arctangent(nan_value, 1)));
  BOOST_TEST(std::isnan(arctangent(1, nan_value)));
}

// --- which elements a grid and a mesh have ---

BOOST_AUTO_TEST_CASE(a_grid_has_two_triangles_a_cell_and_a_hinge_at_every_inner_edge) {
  const TriangleCloth cloth = make_cloth(Grid{64, 64, 0.025}, {.area_density = 0.2});
  BOOST_TEST(cloth.rest.size() == 4096u);
  BOOST_TEST(cloth.triangles.size() == 2u * 63 * 63);
  BOOST_TEST(cloth.hinges.size() == 2u * 63 * 62 + 63 * 63);
  for (const double mass : cloth.mass) BOOST_TEST(mass == 1.25e-4, tolerance(1e-14));
  for (const Hinge& h : cloth.hinges) BOOST_TEST(h.rest_angle == 0);

  const TriangleCloth cell = make_cloth(Grid{2, 2, 0.5}, {});
  BOOST_REQUIRE_EQUAL(cell.hinges.size(), 1u);
  BOOST_TEST(
      (std::set<int>{cell.hinges[0].particles[0], cell.hinges[0].particles[1]} == std::set<int>{0, 3}));
  for (const RestTriangle& t : cell.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vector3d& x = cell.rest[t.particles[c]];
      BOOST_TEST((t.uv[c] == Vector2d(x.x(), x.z())));
    }
}

BOOST_AUTO_TEST_CASE(a_quad_mesh_of_a_grid_is_the_same_cloth_but_for_its_masses) {
  const Grid grid{4, 6, 0.1};
  const Model from_grid(make_cloth(grid, material));
  std::vector<std::vector<int>> quads;
  for (int i = 0; i + 1 < grid.rows; ++i)
    for (int j = 0; j + 1 < grid.columns; ++j) {
      const int p = i * grid.columns + j, q = p + grid.columns;
      quads.push_back((i + j) % 2 ? std::vector{p, p + 1, q + 1, q} : std::vector{q + 1, p + 1, p, q});
    }
  const Model from_mesh(make_cloth(make_mesh(from_grid.cloth.rest, quads), material));
  BOOST_TEST(from_mesh.cloth.triangles.size() == from_grid.cloth.triangles.size());
  BOOST_TEST(from_mesh.cloth.hinges.size() == from_grid.cloth.hinges.size());
  Random random(9);
  Positions x;
  for (const Vector3d& p : from_grid.cloth.rest) x.push_back(p + random.point(0.03));
  const Vector at = from_grid.coordinates(x);
  check_equal(from_mesh.force(from_mesh.stretch_shear(), at), from_grid.force(from_grid.stretch_shear(), at),
              1e-12);
  check_equal(from_mesh.force(from_mesh.bending(), at), from_grid.force(from_grid.bending(), at), 1e-12);
  const auto total = [](const TriangleCloth& c) {
    return std::accumulate(c.mass.begin(), c.mass.end(), 0.0);
  };
  BOOST_TEST(total(from_grid.cloth) == 24 * 0.2 * 0.01, tolerance(1e-12));
  BOOST_TEST(total(from_mesh.cloth) == 15 * 0.2 * 0.01, tolerance(1e-12));
  // an inner particle has six triangles, the second of the first row three
  BOOST_TEST(from_mesh.cloth.mass[7] == 2 * from_mesh.cloth.mass[1], tolerance(1e-12));
  for (const double mass : make_cloth(make_mesh(from_grid.cloth.rest, quads), {.particle_mass = 3e-4}).mass)
    BOOST_TEST(mass == 3e-4);
}

BOOST_AUTO_TEST_CASE(polygons_are_fans_from_their_first_corner) {
  const Mesh mesh = make_mesh({{2, 0, 0}, {1, 0, 2}, {-1, 0, 1}, {-1, 0, -1}, {1, 0, -2}}, {{3, 4, 0, 1, 2}});
  const TriangleCloth cloth = make_cloth(mesh, {});
  BOOST_REQUIRE_EQUAL(cloth.triangles.size(), 3u);
  for (const RestTriangle& t : cloth.triangles) BOOST_TEST(t.particles[0] == 3);
  BOOST_TEST(cloth.hinges.size() == 2u);
}

BOOST_AUTO_TEST_CASE(every_pair_of_pages_is_hinged_at_the_back_of_a_book) {
  const Positions points{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {0, -1, 0.2}};
  const TriangleCloth cloth = make_cloth(make_mesh(points, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 1, 5}}), {});
  std::set<std::set<int>> opposite;
  for (const Hinge& h : cloth.hinges) opposite.insert({h.particles[2], h.particles[3]});
  BOOST_TEST(cloth.hinges.size() == 6u);
  BOOST_TEST((opposite == std::set<std::set<int>>{{2, 3}, {2, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}));
  // the same triangle twice has no angle to itself
  BOOST_TEST(
      make_cloth(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 1}}), {}).hinges.empty());
}

BOOST_AUTO_TEST_CASE(what_has_no_coefficient_is_not_constructed) {
  const Grid grid{4, 5, 0.1};
  std::vector<int> number(20);
  std::iota(number.begin(), number.end(), 0);
  const auto terms = [&](const ClothMaterial& m) { return make_terms(make_cloth(grid, m), number, 20); };
  const auto counts = [&](const PerCondition& k, const PerCondition& d) {
    const SceneTerms t = terms({.stiffness = k, .damping = d});
    return std::make_pair(t.elastic.size(), t.damping.size());
  };
  using Counts = std::pair<std::size_t, std::size_t>;
  BOOST_TEST((counts({1, 1, 1, 1}, {1, 1, 1, 1}) == Counts{2, 2}));
  BOOST_TEST((counts({1, 1, 1, 1}, {}) == Counts{2, 0}));
  BOOST_TEST((counts({0, 1, 0, 0}, {}) == Counts{1, 0}));
  BOOST_TEST((counts({0, 0, 0, 1}, {}) == Counts{1, 0}));
  BOOST_TEST((counts({0, 0, 0, 1}, {0, 0, 0, 1}) == Counts{1, 1}));
  BOOST_TEST((counts({0, 0, 1, 1}, {0, 0, 1, 0}) == Counts{2, 1}));
  BOOST_TEST((counts({}, {}) == Counts{0, 0}));
  BOOST_TEST(make_cloth(grid, {.stiffness = {1, 1, 1, 0}}).hinges.empty());
  BOOST_TEST(make_cloth(grid, {.stiffness = {0, 0, 0, 1}}).triangles.empty());

  // A stencil without bending has the edges alone; pinned elements drop out.
  const auto pairs = [](const Couplings& couplings) {
    std::set<std::pair<int, int>> unique;
    for (auto [i, j] : couplings) unique.insert(std::minmax(i, j));
    return unique.size();
  };
  BOOST_TEST(pairs(terms({.stiffness = {1, 1, 1, 0}}).elastic[0]->couplings()) == 4u * 4 + 3u * 5 + 3u * 4);
  for (int i = 0; i < 20; ++i) number[i] = i < 10 ? 10 + i : i - 10;  // two rows pinned
  const SceneTerms held = make_terms(make_cloth(grid, material), number, 10);
  BOOST_TEST(pairs(held.elastic[0]->couplings()) == 2u * 4 + 5u + 4u);
  for (int i = 0; i < 20; ++i) number[i] = i;
  const SceneTerms fixed = make_terms(make_cloth(grid, material), number, 0);
  BOOST_TEST(fixed.elastic.empty());
  BOOST_TEST(fixed.damping.empty());
}

BOOST_AUTO_TEST_CASE(the_terms_of_a_cloth_have_its_coefficients) {
  Random random(11);
  ClothMaterial m = with(AreaScaling::original);
  m.rest_stretch = {0.9, 1.2};
  const TriangleCloth cloth = make_cloth(sheet(random), m);
  const Model model(cloth, some_pins);
  const SceneTerms terms = make_terms(cloth, model.number, model.free_count);
  const Vector x = model.coordinates(poses(cloth.rest, random)[1].x), v = random.vector(x.size());
  BOOST_REQUIRE_EQUAL(terms.elastic.size(), 2u);
  BOOST_REQUIRE_EQUAL(terms.damping.size(), 2u);
  BOOST_TEST((model.force(*terms.elastic[0], x) == model.force(model.stretch_shear(), x)));
  BOOST_TEST((model.force(*terms.elastic[1], x) == model.force(model.bending(), x)));
  BOOST_TEST((model.force(*terms.damping[0], x, v) == model.force(model.stretch_shear_damping(), x, v)));
  BOOST_TEST((model.force(*terms.damping[1], x, v) == model.force(model.bending_damping(), x, v)));
}

// --- where the triangles lie in (u, v) ---

BOOST_AUTO_TEST_CASE(a_mesh_in_any_plane_has_coordinates_along_the_axis_that_fits_best) {
  Random random(13);
  const Mesh flat = sheet(random);
  const auto uv_of = [&](const Eigen::Matrix3d& turn) {
    Mesh mesh = flat;
    for (Vector3d& x : mesh.vertices) x = turn * x + Vector3d(5, -3, 2);
    return std::make_pair(mesh, make_cloth(mesh, material).triangles);
  };
  // rows of the turn: where x, y, z of the sheet (y is its normal) go
  const auto axes = [](const Vector3d& x, const Vector3d& z) {
    Eigen::Matrix3d turn;
    turn << x, z.cross(x), z;
    return turn;
  };
  const struct {
    Eigen::Matrix3d turn;
    Vector3d u;  // expected direction in space
  } cases[] = {
      {Eigen::Matrix3d::Identity(), {1, 0, 0}},
      {axes({0, 0, 1}, {1, 0, 0}), {1, 0, 0}},
      {axes({1, 0, 0}, {0, 1, 0}), {1, 0, 0}},
      {axes({0, 1, 0}, {0, 0, 1}), {0, 1, 0}},
      {axes(Vector3d(1, 1, 0).normalized(), {0, 0, 1}), {0, 0, 1}},
      {axes(Vector3d(3, 1, 0).normalized(), Vector3d(-1, 3, 1).normalized()), {0, 0, 0}},
  };
  for (const auto& c : cases) {
    const auto [mesh, triangles] = uv_of(c.turn);
    Vector3d u = c.u;
    if (u.norm() == 0) {
      const Vector3d normal = c.turn.col(1);
      Eigen::Index axis = 0;
      normal.cwiseAbs().minCoeff(&axis);
      u = (Vector3d::Unit(axis) - normal[axis] * normal).normalized();
    }
    for (const RestTriangle& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const Vector3d side = mesh.vertices[t.particles[(k + 1) % 3]] - mesh.vertices[t.particles[k]];
        const Vector2d uv = t.uv[(k + 1) % 3] - t.uv[k];
        BOOST_TEST(std::abs(uv.x() - u.dot(side)) < 1e-14);
        BOOST_TEST(std::abs(uv.norm() - side.norm()) < 1e-14);
      }
    for (const Hinge& h : make_cloth(mesh, material).hinges) BOOST_TEST(h.rest_angle == 0);
  }
}

BOOST_AUTO_TEST_CASE(a_bent_mesh_without_texture_is_flattened_triangle_by_triangle) {
  Random random(17);
  Mesh mesh = sheet(random);
  for (Vector3d& x : mesh.vertices) x.y() = 4 * x.x() * x.x() - 2 * x.z() * x.x();
  // and a triangle across the x axis
  mesh = make_mesh(
      [&] {
        Positions v = mesh.vertices;
        v.insert(v.end(), {{3, 0, 0}, {3, 0.3, 0.1}, {3, 0.1, 0.5}});
        return v;
      }(),
      [&] {
        auto f = faces_of(mesh);
        f.push_back({rows * columns, rows * columns + 1, rows * columns + 2});
        return f;
      }());
  const Model model(make_cloth(mesh, material));
  const auto& triangles = model.cloth.triangles;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const auto& t = triangles[k];
    const auto side = [&](int c) -> Vector3d {
      return mesh.vertices[t.particles[c]] - mesh.vertices[t.particles[0]];
    };
    const Vector3d normal = side(1).cross(side(2)).normalized();
    const Vector3d direction = k + 1 == triangles.size() ? Vector3d(0, 0, 1) : Vector3d(1, 0, 0);
    const Vector3d u = (direction - normal.dot(direction) * normal).normalized();
    for (const int c : {1, 2}) {
      const Vector2d uv = t.uv[c] - t.uv[0];
      BOOST_TEST(std::abs(uv.x() - u.dot(side(c))) < 1e-14);
      BOOST_TEST(std::abs(uv.norm() - side(c).norm()) < 1e-14);
    }
  }
  const Vector x = model.coordinates(mesh.vertices);
  BOOST_TEST(model.energy(model.stretch_shear(), x) < 1e-24);
  BOOST_TEST(model.energy(model.bending(), x) < 1e-24);
  double largest = 0;
  for (const Hinge& h : model.cloth.hinges) largest = std::max(largest, std::abs(h.rest_angle));
  BOOST_TEST(largest > 0.1);
}

BOOST_AUTO_TEST_CASE(texture_coordinates_are_the_cloth_of_a_bent_mesh) {
  Random random(19);
  Mesh mesh = sheet(random);
  const Positions flat = mesh.vertices;
  for (Vector3d& x : mesh.vertices) x.y() = 3 * x.x() * x.x();
  for (const int v : mesh.face_vertices) mesh.corner_uv.emplace_back(7 * flat[v].x(), 2 - 7 * flat[v].z());
  mesh.corner_uv[0] += Vector2d(0, 0);
  const auto area = [](const RestTriangle& t) {
    const Vector2d a = t.uv[1] - t.uv[0], b = t.uv[2] - t.uv[0];
    return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
  };
  double surface = 0;
  for (const auto& f : faces_of(mesh)) {
    const auto& v = mesh.vertices;
    surface += (v[f[1]] - v[f[0]]).cross(v[f[2]] - v[f[0]]).norm() / 2;
  }
  const TriangleCloth scaled = make_cloth(mesh, material);
  double in_uv = 0;
  for (const RestTriangle& t : scaled.triangles) in_uv += area(t);
  BOOST_TEST(in_uv == surface, tolerance(1e-12));
  BOOST_TEST(std::accumulate(scaled.mass.begin(), scaled.mass.end(), 0.0) == 0.2 * surface, tolerance(1e-12));

  ClothMaterial m = material;
  m.texture_unit = 1.0 / 7;
  const TriangleCloth cloth = make_cloth(mesh, m);
  for (const RestTriangle& t : cloth.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vector3d side = flat[t.particles[c]] - flat[t.particles[0]];
      BOOST_TEST((t.uv[c] - t.uv[0] - Vector2d(side.x(), -side.z())).norm() < 1e-14);
    }
  double total = 0;
  for (const RestTriangle& t : cloth.triangles) total += 0.2 * area(t);
  BOOST_TEST(std::accumulate(cloth.mass.begin(), cloth.mass.end(), 0.0) == total, tolerance(1e-12));

  // In a plane they are not needed, and where they leave a triangle without area they will not do.
  Mesh planar = mesh;
  planar.vertices = flat;
  for (const RestTriangle& t : make_cloth(planar, m).triangles)
    BOOST_TEST(((t.uv[1] - t.uv[0]).y() == (flat[t.particles[1]] - flat[t.particles[0]]).z()));
  Mesh bad = mesh;
  for (int c = 0; c < 3; ++c) bad.corner_uv[c] = Vector2d(0.1 * c, 0.3 * c);
  const TriangleCloth own = make_cloth(bad, m);
  const RestTriangle& last = own.triangles.back();
  BOOST_TEST((last.uv[1] - last.uv[0]).norm() ==
                 (mesh.vertices[last.particles[1]] - mesh.vertices[last.particles[0]]).norm(),
             tolerance(1e-12));
}

// --- what is refused ---

BOOST_AUTO_TEST_CASE(a_bad_mesh_is_refused_at_its_line) {
  const Positions square{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  const auto moved = [&](int vertex, const Vector3d& to) {
    Positions vertices = square;
    vertices[vertex] = to;
    return vertices;
  };
  const struct {
    Mesh mesh;
    std::string place, words;
  } cases[] = {
      {make_mesh({}, {}), "cloth.obj", "no faces"},
      {make_mesh(square, {{0, 1, 2, 3}, {0, 1}}), "cloth.obj:6", "2 corners"},
      {make_mesh(square, {{0, 1, 2, 3}, {2, 0, 1, 2}}), "cloth.obj:6", "vertex 3 twice"},
      {make_mesh(square, {{0, 1, 2, 4}}), "cloth.obj:5", "vertex 5, expected 1 to 4"},
      {make_mesh(square, {{0, 1, 3}}), "cloth.obj:3", "vertex 3 belongs to no face"},
      {make_mesh(moved(1, {0, nan_value, 0}), {{0, 1, 2, 3}}), "cloth.obj:2", "not finite"},
      {make_mesh(moved(2, {2, 0, 0}), {{0, 1, 3}, {1, 0, 2}}), "cloth.obj:6", "triangle 2-1-3 has no area"},
      {make_mesh(moved(2, {1, 0, 0}), {{0, 1, 3}, {3, 2, 1}}), "cloth.obj:6", "has a side of 0 m"},
      {make_mesh(moved(2, {1e100, 0, 1}), {{0, 1, 3}, {1, 2, 3}}), "cloth.obj:6", "has a side of 1e+100 m"},
      // thin only by rounding: 0.1, 0.2, 0.3 are not exactly on a line
      {make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 0.7}, {0.2, 0.2, 1.4}, {0.3, 0.3, 2.1}},
                 {{0, 1, 2}, {3, 4, 5}}),
       "cloth.obj:8", "triangle 4-5-6 has no area"},
  };
  for (const auto& c : cases) expect_error([&] { make_cloth(c.mesh, {}); }, c.place, c.words);
  expect_error(
      [&] {
        make_cloth(make_mesh(square, {{0, 1, 2, 3}}), {.area_density = 1e-323});
      },
      "cloth.obj:1", "has a mass of");
}

BOOST_AUTO_TEST_CASE(a_bad_grid_is_refused) {
  expect_error([] { make_cloth(Grid{0, 4, 0.1}, {}); }, "grid", "0 x 4");
  expect_error([] { make_cloth(Grid{1, 4, 0.1}, {}); }, "grid", "at least 2 x 2");
  expect_error([] { make_cloth(Grid{4, 1, 0.1}, {}); }, "grid", "at least 2 x 2");
  expect_error([] { make_cloth(Grid{2, 2, 1e-70}, {}); }, "grid", "1e-70 m");
  expect_error([] { make_cloth(Grid{2, 2, nan_value}, {}); }, "grid", "spacing is nan");
  expect_error([] { make_cloth(Grid{2, 2, 1e-60}, {.area_density = 1e-250}); }, "grid", "weighs 0 kg");
  // the smallest and the largest spacing that are allowed have forces
  for (const double s : {1e-60, 1e60}) {
    const Model model(make_cloth(Grid{2, 2, s}, material));
    Random random(23);
    Positions x;
    for (const Vector3d& p : model.cloth.rest) x.push_back(p + random.point(0.1 * s));
    for_each_term(model, [&](const auto& term) {
      const Vector f = model.force(term, model.coordinates(x));
      BOOST_TEST(f.allFinite());
      BOOST_TEST(f.lpNorm<Eigen::Infinity>() > 0);
      BOOST_TEST(model.stiffness(term, model.coordinates(x)).allFinite());
    });
  }
}

BOOST_AUTO_TEST_CASE(a_bad_material_is_refused) {
  const struct {
    ClothMaterial material;
    std::string words;
  } cases[] = {
      {{.area_density = 0}, "area density is 0"},
      {{.particle_mass = -1.0}, "particle mass is -1"},
      {{.stiffness = {-1, 1, 1, 1}}, "stretch u stiffness is -1, expected zero or a positive number of N/m"},
      {{.stiffness = {1, nan_value, 1, 1}}, "stretch v stiffness is nan"},
      {{.stiffness = {1, 1, inf, 1}, .scaling = AreaScaling::original},
       "shear stiffness is inf, expected zero or a "
       "positive number of N/m³"},
      {{.stiffness = {1, 1, 1, -2}}, "bending stiffness is -2, expected zero or a positive number of N·m"},
      {{.damping = {0, 0, 0, -2}}, "bending damping is -2, expected zero or a positive number of N·m·s"},
      {{.stiffness = {1, 1, 0, 1}, .damping = {0, 0, 0.5, 0}}, "shear damping is 0.5, expected zero"},
      {{.rest_stretch = {0, 1}}, "rest stretch is 0"},
      {{.rest_stretch = {1, inf}}, "rest stretch is inf"},
      {{.texture_unit = 0.0}, "texture unit is 0"},
  };
  for (const auto& c : cases) {
    expect_error([&] { check(c.material, "scene.json", 3); }, "scene.json:3", c.words);
    expect_error([&] { make_cloth(Grid{2, 2, 0.1}, c.material); }, "material", c.words);
  }
  BOOST_CHECK_THROW(TriangleConditions({{{0, 1, 2}, {Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)}}},
                                       AreaScaling::continuum, 3),
                    std::invalid_argument);
}

BOOST_AUTO_TEST_SUITE_END()
