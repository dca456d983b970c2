// The laws of solids made of tetrahedra: what an altitude spring stores, that forces are differenced energies
// and stiffness matrices differenced forces, also where tetrahedra are flat or inverted; which springs a mesh
// has; k0 against a dense eigen-solver; that what is inverted recovers.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "analysis/method.h"
#include "analysis/spectra/spectrum.h"
#include "solvers/io/input_error.h"
#include "solvers/io/mesh_file.h"
#include "solvers/linear/dense_solvers.h"
#include "solvers/scene/mesh_repair.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/tet_solid.h"
#include "tests/dense.h"
#include "tests/refusals.h"
#include "tests/shared_data.h"

BOOST_AUTO_TEST_SUITE(tet_solid)

using namespace springstab;
using springstab::test::expect_error;
using springstab::test::smallest_eigenvalue;

namespace {

using Dense = Eigen::MatrixXd;
using Eigen::Vector3d;
using Positions = std::vector<Vector3d>;
using Tets = std::vector<std::array<int, 4>>;

constexpr double eps = std::numeric_limits<double>::epsilon();

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

 private:
  std::mt19937_64 engine_;
};

/// A mesh whose vertex v stands on line v + 1 of the file and whose tetrahedra follow.
TetMesh make_mesh(Positions vertices, const Tets& tets) {
  TetMesh mesh;
  mesh.source = "solid.veg";
  mesh.vertices = std::move(vertices);
  mesh.tets = tets;
  mesh.vertex_line.resize(mesh.vertices.size());
  std::iota(mesh.vertex_line.begin(), mesh.vertex_line.end(), 1L);
  mesh.tet_line.resize(tets.size());
  std::iota(mesh.tet_line.begin(), mesh.tet_line.end(), static_cast<long>(mesh.vertices.size()) + 1);
  return mesh;
}

const Positions corner{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Cubes in a row along x, of five tetrahedra each: more than a batch of altitudes. The vertices moved a
/// little.
TetMesh bar(Random& random, int cubes = 3) {
  Positions vertices;
  for (int i = 0; i <= cubes; ++i)
    for (const auto& [y, z] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
      vertices.push_back(Vector3d(i, y, z) + random.point(0.1));
  Tets tets;
  for (int i = 0; i < cubes; ++i) {
    const int a = 4 * i, b = a + 4;  // 00 10 01 11 of the near and of the far side
    if (i % 2 == 0) {
      for (const auto& t : Tets{{a, b, a + 1, a + 2},
                                {b + 3, b, a + 1, b + 1},
                                {b + 3, b, a + 2, b + 2},
                                {a + 3, a + 1, a + 2, b + 3},
                                {b, a + 1, a + 2, b + 3}})
        tets.push_back(t);
    } else {
      for (const auto& t : Tets{{a + 1, a, a + 3, b + 1},
                                {a + 2, a, a + 3, b + 2},
                                {b, a, b + 1, b + 2},
                                {b + 3, b + 1, a + 3, b + 2},
                                {a, a + 3, b + 1, b + 2}})
        tets.push_back(t);
    }
  }
  return make_mesh(vertices, tets);
}

const SolidMaterial material{.density = 800, .stiffness = {900, 700}, .damping = {0.5, 0.7}};

/// A solid in a scene's numbers, some of its particles pinned.
struct Model {
  TetSolid solid;
  int free_count;
  std::vector<int> number;
  SceneTerms terms;

  Model(const TetSolid& of, const std::vector<int>& pinned = {})
      : solid(of), free_count(static_cast<int>(of.rest.size() - pinned.size())) {
    int next_free = 0, next_pinned = free_count;
    for (int i = 0; i < static_cast<int>(of.rest.size()); ++i)
      number.push_back(std::ranges::count(pinned, i) ? next_pinned++ : next_free++);
    terms = make_terms(solid, number, free_count);
  }

  const ElasticTerm& altitude_springs() const { return *terms.elastic.back(); }
  DampingTerm& altitude_damping() const { return *terms.damping.back(); }

  /// All coordinates in the scene's order.
  Vector coordinates(const Positions& x) const {
    Vector all(3 * static_cast<Eigen::Index>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i) all.segment<3>(3 * number[i]) = x[i];
    return all;
  }
  ParticleField field(const Vector& all) const {
    return {all.data(), all.data() + 3 * free_count, free_count};
  }
  double energy(const Vector& x) const { return altitude_springs().energy(field(x)); }
  Vector force(const Vector& x) const {
    Vector f = Vector::Zero(3 * free_count);
    altitude_springs().add_force(field(x), f.data());
    return f;
  }
  Dense stiffness(const Vector& x, bool projected = false) const {
    BlockSparseMatrix matrix(free_count, altitude_springs().couplings());
    projected ? altitude_springs().add_projected_stiffness(field(x), matrix)
              : altitude_springs().add_stiffness(field(x), matrix);
    return Dense(matrix.to_sparse());
  }
  Vector damping_force(const Vector& x, const Vector& v) const {
    Vector f = Vector::Zero(3 * free_count);
    altitude_damping().add_force(field(x), field(v), f.data());
    return f;
  }
  Dense damping(const Vector& x) const {
    BlockSparseMatrix matrix(free_count, altitude_damping().couplings());
    altitude_damping().add_damping(field(x), matrix);
    return Dense(matrix.to_sparse());
  }
};

struct Pose {
  std::string name;
  Positions x;
};

std::vector<Pose> poses(const Positions& rest, Random& random) {
  const auto moved = [&](double noise, const std::function<Vector3d(const Vector3d&)>& map) {
    Positions x;
    for (const Vector3d& p : rest) x.push_back(map(p) + random.point(noise));
    return x;
  };
  return {
      {"rest", rest},
      {"random", moved(0.15, [](const Vector3d& p) { return p; })},
      {"compressed", moved(0.02, [](const Vector3d& p) { return Vector3d(0.6 * p); })},
      {"sheared", moved(0.02, [](const Vector3d& p) { return Vector3d(p.x() + 0.7 * p.z(), p.y(), p.z()); })},
      {"flat", moved(0, [](const Vector3d& p) { return Vector3d(p.x(), p.y() + 0.6 * p.z(), 0); })},
      {"inverted", moved(0.05, [](const Vector3d& p) { return Vector3d(p.x(), p.y(), -p.z()); })}};
}

const std::vector<int> some_pins{1, 4, 11};

void for_each_pose(const std::function<void(const Model&, const Pose&, Random&)>& visit,
                   const std::vector<int>& pinned = some_pins) {
  for (const std::uint64_t seed : {1u, 2u}) {
    Random random(seed);
    const TetMesh mesh = bar(random);
    const Model model(make_solid(mesh, material), pinned);
    for (const Pose& pose : poses(mesh.vertices, random))
      BOOST_TEST_CONTEXT("seed " << seed << ", " << pose.name) { visit(model, pose, random); }
  }
}

/// The derivatives along each of the first `count` coordinates by central differences of two steps,
/// extrapolated to fourth order (Richardson). The faces' heights are above 0.3 m (the flat pose's above
/// 0.05), so that a step of 2e-5 leaves (2e-5/0.05)⁴ = 3e-14 of truncation and eps/2e-5 = 1e-11 of rounding.
constexpr double step = 2e-5, difference_tolerance = 1e-8;

Dense differenced(const std::function<Vector(const Vector&)>& f, const Vector& x, Eigen::Index count) {
  const auto central = [&](Eigen::Index j, double h) -> Vector {
    const Vector u = h * Vector::Unit(x.size(), j);
    return (f(x + u) - f(x - u)) / (2 * h);
  };
  Dense jacobian(f(x).size(), count);
  for (Eigen::Index j = 0; j < count; ++j)
    jacobian.col(j) = (4 * central(j, step / 2) - central(j, step)) / 3;
  return jacobian;
}

void check_equal(const Dense& found, const Dense& expected, double relative) {
  BOOST_TEST((found - expected).norm() <= relative * expected.norm(),
             "relative difference " << (found - expected).norm() / expected.norm());
}

/// K and M of the whole solid at rest, spring by spring: both kinds store ½ k (∇·δx)² there.
std::pair<Dense, Vector> dense_matrices(const TetSolid& solid) {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(solid.rest.size());
  Dense k = Dense::Zero(n, n);
  for (const Spring& s : solid.edges) {
    Vector g = Vector::Zero(n);
    const Vector3d u = (solid.rest[s.i] - solid.rest[s.j]).normalized();
    g.segment<3>(3 * s.i) = u;
    g.segment<3>(3 * s.j) = -u;
    k += s.stiffness * g * g.transpose();
  }
  for (const Altitude& a : solid.altitudes) {
    const auto& [p, q, r, s] = a.particles;
    const Vector3d normal = (solid.rest[r] - solid.rest[q]).cross(solid.rest[s] - solid.rest[q]).normalized();
    Dense corners(3, 3);  // the foot of the apex as a sum of the face's corners
    corners << solid.rest[q], solid.rest[r], solid.rest[s];
    Eigen::Matrix<double, 4, 3> equations;
    equations << corners, Eigen::RowVector3d::Ones();
    Eigen::Vector4d right;
    right << solid.rest[p] - a.rest * normal, 1;
    const Vector3d weight = equations.colPivHouseholderQr().solve(right);
    Vector g = Vector::Zero(n);
    g.segment<3>(3 * p) = normal;
    g.segment<3>(3 * q) = -weight[0] * normal;
    g.segment<3>(3 * r) = -weight[1] * normal;
    g.segment<3>(3 * s) = -weight[2] * normal;
    k += solid.material.stiffness.altitude * g * g.transpose();
  }
  return {k, springstab::lumped_mass(solid.mass).diagonal()};
}

double dense_k0(const TetSolid& solid) {
  const auto [k, mass] = dense_matrices(solid);
  const Vector root = mass.cwiseSqrt().cwiseInverse();
  return Eigen::SelfAdjointEigenSolver<Dense>(Dense(root.asDiagonal() * k * root.asDiagonal()))
      .eigenvalues()
      .maxCoeff();
}

}  // namespace

// --- which springs a mesh has ---

BOOST_AUTO_TEST_CASE(a_tetrahedron_has_six_edges_and_four_altitudes) {
  const TetSolid solid = make_solid(make_mesh(corner, {{0, 1, 2, 3}}), material);
  BOOST_TEST(solid.edges.size() == 6u);
  BOOST_REQUIRE_EQUAL(solid.altitudes.size(), 4u);
  std::set<int> apexes;
  for (const Altitude& a : solid.altitudes) {
    apexes.insert(a.particles[0]);
    const double expected = a.particles[0] == 0 ? 1 / std::sqrt(3.0) : 1;
    BOOST_TEST(a.rest == expected, boost::test_tools::tolerance(4 * eps));
  }
  BOOST_TEST(apexes.size() == 4u);
  for (const double m : solid.mass) BOOST_TEST(m == 800.0 / 24, boost::test_tools::tolerance(4 * eps));
}

BOOST_AUTO_TEST_CASE(edges_are_shared_and_the_mass_is_density_times_volume) {
  Random random(1);
  const TetMesh mesh = bar(random);
  const TetSolid solid = make_solid(mesh, material);
  BOOST_TEST(solid.edges.size() ==
             16u + 12 + 12 + 4);  // around and along the bar, diagonals of its sides and of four sections
  BOOST_TEST(solid.altitudes.size() == 60u);
  double volume = 0;
  for (int t = 0; t < 15; ++t) volume += std::abs(mesh.six_volumes(t)) / 6;
  const double mass = std::accumulate(solid.mass.begin(), solid.mass.end(), 0.0);
  BOOST_TEST(mass == 800 * volume, boost::test_tools::tolerance(100 * eps));
  for (const Altitude& a : solid.altitudes) BOOST_TEST(a.rest > 0.3);
}

BOOST_AUTO_TEST_CASE(how_a_tetrahedron_is_written_changes_nothing) {
  Random random(2);
  Positions x = corner;
  for (Vector3d& p : x) p += random.point(0.3);
  std::array<int, 4> order{0, 1, 2, 3};
  const Model first(make_solid(make_mesh(corner, {order}), material));
  const double energy = first.energy(first.coordinates(x));
  const Vector force = first.force(first.coordinates(x));
  BOOST_TEST(energy > 1);
  while (std::next_permutation(order.begin(), order.end())) {
    const Model other(make_solid(make_mesh(corner, {order}), material));
    BOOST_TEST(other.energy(other.coordinates(x)) == energy, boost::test_tools::tolerance(100 * eps));
    check_equal(other.force(other.coordinates(x)), force, 100 * eps);
  }
}

BOOST_AUTO_TEST_CASE(what_has_no_coefficient_is_not_constructed) {
  const TetMesh mesh = make_mesh(corner, {{0, 1, 2, 3}});
  const auto terms = [&](const SolidMaterial& m, const std::vector<int>& pinned) {
    const Model model(make_solid(mesh, m), pinned);
    return std::pair(model.terms.elastic.size(), model.terms.damping.size());
  };
  BOOST_TEST((terms(material, {}) == std::pair<std::size_t, std::size_t>(2, 2)));
  BOOST_TEST((terms({.stiffness = {1, 0}}, {}) == std::pair<std::size_t, std::size_t>(1, 0)));
  BOOST_TEST((terms({.stiffness = {0, 1}}, {}) == std::pair<std::size_t, std::size_t>(1, 0)));
  BOOST_TEST(
      (terms({.stiffness = {1, 1}, .damping = {0, 1}}, {}) == std::pair<std::size_t, std::size_t>(2, 1)));
  BOOST_TEST((terms(material, {0, 1, 2, 3}) == std::pair<std::size_t, std::size_t>(0, 0)));
}

BOOST_AUTO_TEST_CASE(the_surface_faces_outwards) {
  Random random(3);
  TetMesh mesh = repaired(bar(random)).mesh;
  const auto faces = boundary(mesh);
  BOOST_TEST(faces.size() == 2u * (2 + 4 * 3));  // 14 squares in two triangles each
  double six_volumes = 0, expected = 0;          // by the divergence theorem
  for (const auto& f : faces)
    six_volumes += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]]));
  for (int t = 0; t < 15; ++t) expected += mesh.six_volumes(t);
  BOOST_TEST(six_volumes == expected, boost::test_tools::tolerance(1e-13));
  BOOST_TEST(expected > 15);
}

// --- derivatives ---

BOOST_AUTO_TEST_CASE(a_force_is_the_differenced_energy) {
  for_each_pose([](const Model& model, const Pose& pose, Random&) {
    const Vector x = model.coordinates(pose.x), f = model.force(x);
    if (pose.name == "rest") {
      BOOST_TEST(f.norm() < 1e-11);
      BOOST_TEST(model.energy(x) < 1e-25);
      return;
    }
    const auto energy = [&](const Vector& at) { return Vector::Constant(1, model.energy(at)); };
    check_equal(f, -differenced(energy, x, f.size()).transpose(), difference_tolerance);
    BOOST_TEST(f.norm() > 10);
  });
}

BOOST_AUTO_TEST_CASE(the_stiffness_matrix_is_the_differenced_force) {
  for_each_pose([](const Model& model, const Pose& pose, Random&) {
    const Vector x = model.coordinates(pose.x);
    const Dense k = model.stiffness(x);
    check_equal(k, -differenced([&](const Vector& at) { return model.force(at); }, x, k.cols()),
                difference_tolerance);
    BOOST_TEST((k == k.transpose()));
    for (Eigen::Index i = 0; i < k.rows(); i += 3) BOOST_TEST((k.block<3, 3>(i, i).norm() > 10));
  });
}

BOOST_AUTO_TEST_CASE(a_product_with_the_stiffness_needs_no_matrix) {
  for_each_pose([](const Model& model, const Pose& pose, Random& random) {
    const Vector x = model.coordinates(pose.x), u = random.vector(3 * model.free_count);
    Vector out = Vector::Zero(u.size());
    model.altitude_springs().add_stiffness_times(model.field(x), u.data(), -0.7, out.data());
    check_equal(out, -0.7 * model.stiffness(x) * u, 1e-12);
    BOOST_TEST(out.norm() > 10);
    Vector force = Vector::Zero(u.size()), damped = force;
    model.altitude_springs().add_force(model.field(x), force.data());
    model.altitude_springs().add_damped_force(model.field(x), u.data(), 0.7, damped.data());
    check_equal(damped, force + out, 1e-12);
  });
}

// --- symmetries and definiteness ---

BOOST_AUTO_TEST_CASE(a_free_solid_exerts_no_force_and_no_torque_on_itself) {
  for_each_pose(
      [](const Model& model, const Pose& pose, Random& random) {
        const Vector x = model.coordinates(pose.x), v = random.vector(x.size());
        for (const Vector& f : {model.force(x), model.damping_force(x, v)}) {
          Vector3d force(0, 0, 0), torque(0, 0, 0);
          for (Eigen::Index i = 0; i < f.size(); i += 3) {
            force += f.segment<3>(i);
            torque += Vector3d(x.segment<3>(i)).cross(Vector3d(f.segment<3>(i)));
          }
          const double size = std::max(f.norm(), 1.0) * x.norm();
          BOOST_TEST(force.norm() <= 1e-12 * size);
          BOOST_TEST(torque.norm() <= 1e-12 * size);
        }
      },
      {});
}

BOOST_AUTO_TEST_CASE(a_projected_stiffness_is_positive_semidefinite_and_exact_at_rest) {
  for_each_pose([](const Model& model, const Pose& pose, Random&) {
    const Vector x = model.coordinates(pose.x);
    const Dense projected = model.stiffness(x, true), exact = model.stiffness(x);
    BOOST_TEST(smallest_eigenvalue(projected) >= -1e-12 * projected.norm());
    if (pose.name == "rest") {
      check_equal(projected, exact, 1e-12);
    } else {
      BOOST_TEST((projected - exact).norm() > 1e-3 * exact.norm());
    }
  });
}

BOOST_AUTO_TEST_CASE(damping_resists_the_rates_of_the_altitudes_alone) {
  for_each_pose([](const Model& model, const Pose& pose, Random& random) {
    const Vector x = model.coordinates(pose.x);
    const Dense c = model.damping(x);
    // with unit stiffness and damping the two matrices of gradients are one
    check_equal(c, model.stiffness(x, true) * (0.7 / 700), 1e-12);
    Vector v = random.vector(x.size());
    v.tail(x.size() - 3 * model.free_count).setZero();
    check_equal(model.damping_force(x, v), -c * v.head(3 * model.free_count), 1e-12);
    BOOST_TEST(c.norm() > 0.1);
  });
}

// --- inversion ---

BOOST_AUTO_TEST_CASE(a_flat_or_inverted_tetrahedron_is_driven_back_smoothly) {
  const Model model(make_solid(make_mesh(corner, {{0, 1, 2, 3}}), {.stiffness = {0, 2}}), {1, 2, 3});
  const Vector3d normal = Vector3d(1, 1, 1) / std::sqrt(3.0), foot = Vector3d(1, 1, 1) / 3;
  double before = 0;
  for (int i = -50; i <= 50; ++i) {  // through the plane of the face opposite; at rest it is at 0.577
    const double h = 0.01 * i;
    Positions x = corner;
    x[0] = foot - h * normal;
    const double back = -model.force(model.coordinates(x)).dot(normal);  // towards larger h
    BOOST_TEST(back > 0.1);
    // the stiffness along this path is a few k = 2 N/m at most: steps of 0.01 m change the force by less than
    // this
    if (i > -50) BOOST_TEST(std::abs(back - before) < 1);
    before = back;
  }
}

BOOST_AUTO_TEST_CASE(an_inverted_solid_recovers) {
  Random random(4);
  const TetMesh mesh = make_mesh(corner, {{0, 1, 2, 3}});
  const Scene prototype(make_solid(mesh, material), {}, {0, 0, 0}, {.d0 = 20, .alpha = 0});
  for (const char* method : {"symplectic-euler", "rk4"}) BOOST_TEST_CONTEXT(method) {
      Scene scene(make_solid(mesh, material), {}, {0, 0, 0}, {.d0 = 20, .alpha = 0});
      State<Vector> state = prototype.rest_state();
      for (Eigen::Index i = 2; i < state.x.size(); i += 3) state.x[i] *= -1;
      const auto volume = [&] {
        TetMesh now = mesh;
        now.vertices = scene.positions(state.x);
        return now.six_volumes(0);
      };
      BOOST_TEST(volume() == -1, boost::test_tools::tolerance(1e-12));
      const auto stepper = Method(method).stepper();
      for (int i = 0; i < 20000; ++i) BOOST_REQUIRE((stepper->step(scene, 1e-3, state) == StepStatus::done));
      BOOST_TEST(volume() == 1, boost::test_tools::tolerance(1e-6));
      BOOST_TEST(scene.elastic_energy(state.x) < 1e-9);
    }
}

BOOST_AUTO_TEST_CASE(a_collapsed_face_has_no_force_and_the_step_says_so) {
  Scene scene(make_solid(make_mesh(corner, {{0, 1, 2, 3}}), material), {}, {0, 0, 0}, {});
  State<Vector> state = scene.rest_state();
  state.x.segment<3>(6) = (state.x.segment<3>(3) + state.x.segment<3>(9)) / 2;
  const State<Vector> before = state;
  BOOST_TEST((Method("rk4").stepper()->step(scene, 1e-3, state) == StepStatus::diverged));
  BOOST_TEST((state.x == before.x));
}

// --- k0 ---

BOOST_AUTO_TEST_CASE(k0_is_that_of_a_dense_eigen_solver) {
  Random random(5);
  std::vector<std::pair<std::string, TetMesh>> meshes{{"corner", make_mesh(corner, {{0, 1, 2, 3}})},
                                                      {"bar", bar(random, 8)}};
  for (const std::string name : {"sofa_truss_tetra.msh", "vega_beam3_tet.veg"})
    if (const auto path = test::shared_data("meshes/" + name))
      meshes.emplace_back(name, std::get<TetMesh>(read_mesh(path->string())));
  for (const auto& [name, mesh] : meshes) BOOST_TEST_CONTEXT(name) {
      const TetSolid solid = make_solid(repaired(mesh).mesh, {});
      Scene scene(solid, {}, {0, 0, 0}, {});
      const State<Vector> rest = scene.rest_state();
      BlockLinearSystem linear = *scene.linearization(rest);
      StructuralMatrices s;
      s.stiffness = linear.stiffness().to_sparse();
      s.mass = springstab::lumped_mass(linear.mass());
      const StiffestMode k0 = stiffest_mode(s, {});
      const double expected = dense_k0(solid);
      BOOST_TEST_MESSAGE(name << ": k0 " << k0.value << ", dense " << expected);
      BOOST_TEST(k0.converged);
      BOOST_TEST(k0.value == expected, boost::test_tools::tolerance(1e-9));
      BOOST_TEST(k0.upper_bound >= expected * (1 - 1e-12));
      BOOST_TEST(expected > 1);
    }
}

// --- repair ---

BOOST_AUTO_TEST_CASE(each_defect_of_a_solid_is_mended_and_counted) {
  const auto with = [](Positions list, const Positions& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
  };
  const struct {
    std::string name;
    TetMesh mesh;
    /// merged, degenerate, duplicate, unreferenced, turned, crowded
    std::vector<int> counts;
    Tets tets;
  } cases[] = {
      {"sound", make_mesh(corner, {{0, 1, 2, 3}}), {0, 0, 0, 0, 0, 0}, {{0, 1, 2, 3}}},
      {"left-handed", make_mesh(corner, {{0, 2, 1, 3}}), {0, 0, 0, 0, 1, 0}, {{0, 2, 3, 1}}},
      {"twice", make_mesh(corner, {{0, 1, 2, 3}, {3, 1, 0, 2}}), {0, 0, 1, 0, 0, 0}, {{0, 1, 2, 3}}},
      {"a corner twice", make_mesh(corner, {{0, 1, 1, 3}, {0, 1, 2, 3}}), {0, 1, 0, 0, 0, 0}, {{0, 1, 2, 3}}},
      {"a loose vertex",
       make_mesh(with({{9, 9, 9}}, corner), {{1, 2, 3, 4}}),
       {0, 0, 0, 1, 0, 0},
       {{0, 1, 2, 3}}},
      {"a seam",
       make_mesh(with(corner, {{1, 0, 0}, {1, 1, 1}}), {{0, 1, 2, 3}, {4, 2, 3, 5}}),
       {1, 0, 0, 0, 0, 0},
       {{0, 1, 2, 3}, {1, 2, 3, 4}}},
      {"folded over",
       make_mesh(with(corner, {{0.1, 0.1, 0.1}}), {{0, 1, 2, 3}, {4, 1, 2, 3}}),
       {0, 0, 0, 0, 0, 1},
       {{0, 1, 2, 3}, {4, 1, 2, 3}}},
      {"three at a face",
       make_mesh(with(corner, {{1, 1, 1}, {2, 2, 2}}), {{0, 1, 2, 3}, {1, 2, 3, 4}, {1, 2, 3, 5}}),
       {0, 0, 0, 0, 0, 1},
       {{0, 1, 2, 3}, {1, 2, 3, 4}, {1, 2, 3, 5}}},
  };
  for (const auto& c : cases) BOOST_TEST_CONTEXT(c.name) {
      const auto [mesh, r] = repaired(c.mesh);
      const std::vector<int> counts{r.merged_vertices,       r.degenerate_elements, r.duplicate_elements,
                                    r.unreferenced_vertices, r.turned_elements,     r.crowded};
      BOOST_TEST(counts == c.counts, boost::test_tools::per_element());
      BOOST_TEST((mesh.tets == c.tets));
      for (int t = 0; t < static_cast<int>(mesh.tets.size()); ++t) BOOST_TEST(mesh.six_volumes(t) > 0);
      const auto again = repaired(mesh).repair;
      BOOST_TEST(!again.changed());
      make_solid(mesh, material);
    }
}

BOOST_AUTO_TEST_CASE(a_bad_solid_is_refused_at_its_line) {
  const auto moved = [](int vertex, const Vector3d& to) {
    Positions vertices = corner;
    vertices[vertex] = to;
    return vertices;
  };
  const struct {
    TetMesh mesh;
    std::string place, words;
  } cases[] = {
      {make_mesh(corner, {}), "solid.veg", "no tetrahedra"},
      {make_mesh(moved(3, {0.3, 0.3, 0}), {{0, 1, 2, 3}}), "solid.veg:5", "has no volume"},
      {make_mesh(moved(3, {0.3, 0.3, 1e-13}), {{0, 1, 2, 3}}), "solid.veg:5", "has no volume"},
      {make_mesh(moved(3, {0, 0, 1e200}), {{0, 1, 2, 3}}), "solid.veg:5", "an edge of inf m"},
      {make_mesh(moved(3, {0, 0, 0}), {{0, 1, 2, 3}}), "solid.veg:5", "an edge of 0 m"},
  };
  for (const auto& c : cases) expect_error([&] { make_solid(c.mesh, {}); }, c.place, c.words);
  expect_error(
      [&] {
        repaired(make_mesh(moved(3, {0, 0, 0}), {{0, 1, 2, 3}}));
      },
      "solid.veg:5", "four corners");
  expect_error(
      [&] {
        make_solid(make_mesh(corner, {{0, 1, 2, 3}}), {.density = 1e-323});
      },
      "solid.veg:1", "has a mass of");
}

BOOST_AUTO_TEST_CASE(a_bad_solid_material_is_refused) {
  for (const SolidMaterial& bad : {SolidMaterial{.density = 0},
                                   {.particle_mass = -1.0},
                                   {.stiffness = {-1, 0}},
                                   {.stiffness = {1, std::numeric_limits<double>::infinity()}},
                                   {.stiffness = {0, 1}, .damping = {1, 0}}})
    expect_error([&] { check(bad, "scene.json", 3); }, "scene.json:3", "");
}

BOOST_AUTO_TEST_SUITE_END()
