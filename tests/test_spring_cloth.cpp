// The laws of a net: which springs a grid and a mesh have, what they weigh, and what is refused where.
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "solvers/io/input_error.h"
#include "solvers/scene/spring_cloth.h"
#include "tests/meshes.h"
#include "tests/refusals.h"

BOOST_AUTO_TEST_SUITE(spring_cloth)

using namespace springstab;
using springstab::test::expect_error;
using springstab::test::make_mesh;

namespace {

using IndexPair = std::pair<int, int>;

/// The grid's cells as quads, some the other way round than a neighbour and each with another first corner.
Mesh quad_mesh(const Grid& grid) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j) vertices.emplace_back(j * grid.spacing, 0, i * grid.spacing);
  std::vector<std::vector<int>> faces;
  for (int i = 0; i + 1 < grid.rows; ++i)
    for (int j = 0; j + 1 < grid.columns; ++j) {
      const int p = i * grid.columns + j, q = p + grid.columns;
      std::vector<int> face{p, p + 1, q + 1, q};
      std::rotate(face.begin(), face.begin() + (i + 2 * j) % 4, face.end());
      if ((2 * i + j) % 3 == 1) std::reverse(face.begin(), face.end());
      faces.push_back(face);
    }
  return make_mesh(vertices, faces);
}

SpringMaterial only(double PerKind::*kind) {
  SpringMaterial material;
  material.stiffness = {};
  material.stiffness.*kind = 7;
  material.damping.*kind = 0.3;
  return material;
}

std::set<IndexPair> pairs(const SpringNet& net) {
  std::set<IndexPair> pairs;
  for (const Spring& s : net.springs) pairs.emplace(s.i, s.j);
  BOOST_TEST(pairs.size() == net.springs.size(), "a pair has two springs");
  return pairs;
}

const double inf = std::numeric_limits<double>::infinity();
const double nan_value = std::numeric_limits<double>::quiet_NaN();

const std::vector<Eigen::Vector3d> unit_square{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};

}  // namespace

BOOST_AUTO_TEST_CASE(a_grid_has_the_springs_that_the_formulas_count) {
  for (const auto& [n, m] : {IndexPair{1, 1}, {1, 5}, {5, 1}, {2, 2}, {2, 3}, {3, 2}, {4, 7}, {6, 5}}) {
    const Grid grid{n, m, 0.025};
    const auto count = [&](double PerKind::*kind) {
      return static_cast<int>(make_net(grid, only(kind)).springs.size());
    };
    BOOST_TEST(count(&PerKind::structural) == n * (m - 1) + (n - 1) * m);
    BOOST_TEST(count(&PerKind::shear) == 2 * (n - 1) * (m - 1));
    BOOST_TEST(count(&PerKind::bending) == n * std::max(m - 2, 0) + std::max(n - 2, 0) * m);
  }
}

BOOST_AUTO_TEST_CASE(a_kind_of_spring_has_its_length_stiffness_and_damping) {
  const double spacing = 0.1;
  const SpringNet net = make_net(Grid{4, 5, spacing}, {.stiffness = {3, 2, 1}, .damping = {0.3, 0.2, 0.1}});
  BOOST_TEST(net.springs.size() == 31u + 24u + 22u);
  for (const Spring& s : net.springs) {
    const double length = s.stiffness == 3   ? spacing
                          : s.stiffness == 2 ? std::sqrt(2) * spacing
                                             : 2 * spacing;
    BOOST_TEST(s.rest_length == length, boost::test_tools::tolerance(1e-14));
    BOOST_TEST(s.rest_length == (net.rest[s.i] - net.rest[s.j]).norm());
    BOOST_TEST(s.damping == s.stiffness / 10, boost::test_tools::tolerance(1e-15));
  }
}

BOOST_AUTO_TEST_CASE(a_grid_lies_in_the_xz_plane_and_each_particle_weighs_one_cell) {
  const SpringNet net = make_net(Grid{3, 4, 0.5}, {.area_density = 0.6});
  BOOST_TEST(net.rest.size() == 12u);
  BOOST_TEST((net.rest[2 * 4 + 1] == Eigen::Vector3d(0.5, 0, 1)));
  for (const double mass : net.mass) BOOST_TEST(mass == 0.15, boost::test_tools::tolerance(1e-15));
}

BOOST_AUTO_TEST_CASE(a_quad_mesh_of_a_grid_has_exactly_the_springs_of_the_grid) {
  for (const auto& [n, m] : {IndexPair{2, 2}, {2, 6}, {6, 2}, {3, 3}, {5, 7}}) {
    const Grid grid{n, m, 0.025};
    const SpringMaterial material{.stiffness = {3, 2, 1}, .damping = {0.3, 0.2, 0.1}};
    const SpringNet from_grid = make_net(grid, material), from_mesh = make_net(quad_mesh(grid), material);
    BOOST_REQUIRE(from_grid.springs.size() == from_mesh.springs.size());
    for (std::size_t k = 0; k < from_grid.springs.size(); ++k) {
      const Spring &a = from_grid.springs[k], &b = from_mesh.springs[k];
      BOOST_TEST((a.i == b.i && a.j == b.j && a.stiffness == b.stiffness && a.damping == b.damping &&
                  a.rest_length == b.rest_length),
                 n << " x " << m << ": spring " << k << " joins " << a.i << "-" << a.j << " in the grid, "
                   << b.i << "-" << b.j << " in the mesh");
    }
  }
}

BOOST_AUTO_TEST_CASE(two_triangles_are_bent_by_one_spring_between_the_opposite_vertices) {
  for (const auto& second : {std::vector{0, 2, 3}, {3, 2, 0}, {2, 3, 0}}) {
    const Mesh mesh = make_mesh(unit_square, {{0, 1, 2}, second});
    BOOST_TEST((pairs(make_net(mesh, only(&PerKind::bending))) == std::set<IndexPair>{{1, 3}}));
    BOOST_TEST(make_net(mesh, only(&PerKind::shear)).springs.empty());
    BOOST_TEST(make_net(mesh, only(&PerKind::structural)).springs.size() == 5u);
  }
}

BOOST_AUTO_TEST_CASE(a_triangle_beside_a_quad_is_bent_at_both_ends_of_their_edge) {
  std::vector<Eigen::Vector3d> vertices = unit_square;
  vertices.emplace_back(2, 0, 0.4);
  const Mesh mesh = make_mesh(vertices, {{0, 1, 2, 3}, {1, 4, 2}});
  BOOST_TEST((pairs(make_net(mesh, only(&PerKind::bending))) == std::set<IndexPair>{{0, 4}, {3, 4}}));
  BOOST_TEST((pairs(make_net(mesh, only(&PerKind::shear))) == std::set<IndexPair>{{0, 2}, {1, 3}}));
}

BOOST_AUTO_TEST_CASE(a_pentagon_is_sheared_along_its_five_diagonals) {
  const Mesh mesh = make_mesh({{2, 0, 0}, {1, 0, 2}, {-1, 0, 1}, {-1, 0, -1}, {1, 0, -2}}, {{0, 1, 2, 3, 4}});
  BOOST_TEST((pairs(make_net(mesh, only(&PerKind::shear))) ==
              std::set<IndexPair>{{0, 2}, {0, 3}, {1, 3}, {1, 4}, {2, 4}}));
}

BOOST_AUTO_TEST_CASE(every_pair_of_pages_is_bent_at_the_back_of_a_book) {
  const Mesh mesh = make_mesh({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}, {0, -1, 0.2}},
                              {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 1, 5}});
  BOOST_TEST((pairs(make_net(mesh, only(&PerKind::bending))) ==
              std::set<IndexPair>{{2, 3}, {2, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}));
}

BOOST_AUTO_TEST_CASE(a_fold_that_an_edge_holds_gets_no_second_spring) {
  const Mesh tetrahedron =
      make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}});
  const SpringNet net = make_net(tetrahedron, {.stiffness = {3, 2, 1}});
  BOOST_TEST(pairs(net).size() == 6u);
  for (const Spring& s : net.springs) BOOST_TEST(s.stiffness == 3);
  BOOST_TEST(pairs(make_net(tetrahedron, only(&PerKind::bending))).size() == 6u);
}

BOOST_AUTO_TEST_CASE(two_sides_of_one_triangle_join_no_particle_to_itself) {
  const Mesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 1}});
  BOOST_TEST((pairs(make_net(mesh, {})) == std::set<IndexPair>{{0, 1}, {0, 2}, {1, 2}}));
}

BOOST_AUTO_TEST_CASE(the_mass_of_a_mesh_is_its_density_times_its_area) {
  // A tilted, stretched net: one linear map takes the area of the parameter plane to |u × v| per unit.
  const Eigen::Vector3d u(1.5, 0.3, -0.2), v(0.1, -0.4, 0.9);
  Mesh mesh = quad_mesh({4, 6, 0.25});
  for (auto& x : mesh.vertices) x = Eigen::Vector3d(5, -3, 2) + x.x() * u + x.z() * v;
  const double area = 3 * 5 * 0.25 * 0.25 * u.cross(v).norm();
  const SpringNet net = make_net(mesh, {.area_density = 0.35});
  const double total = std::accumulate(net.mass.begin(), net.mass.end(), 0.0);
  BOOST_TEST(total == 0.35 * area, boost::test_tools::tolerance(1e-13));
  BOOST_TEST(net.mass[7] == 4 * net.mass[0], boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_polygon_weighs_its_area_even_where_it_is_not_convex) {
  // An L of area 3 whose fan from its first corner folds back over itself.
  const Mesh mesh =
      make_mesh({{2, 0, 0}, {2, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}, {0, 0, 0}}, {{0, 1, 2, 3, 4, 5}});
  for (const double mass : make_net(mesh, {.area_density = 2}).mass)
    BOOST_TEST(mass == 1, boost::test_tools::tolerance(1e-14));
}

BOOST_AUTO_TEST_CASE(a_particle_mass_overrides_the_density) {
  const SpringMaterial material{.area_density = 0.2, .particle_mass = 1.25e-4};
  for (const double mass : make_net(Grid{2, 3, 0.5}, material).mass) BOOST_TEST(mass == 1.25e-4);
  for (const double mass : make_net(quad_mesh({2, 3, 0.5}), material).mass) BOOST_TEST(mass == 1.25e-4);
}

BOOST_AUTO_TEST_CASE(a_mesh_without_lines_still_names_its_file) {
  Mesh mesh = make_mesh(unit_square, {{0, 1, 1, 2}});
  mesh.face_line.clear();
  expect_error([&] { make_net(mesh, {}); }, "cloth.obj", "vertex 2 twice");
}

BOOST_AUTO_TEST_CASE(a_bad_mesh_is_refused_at_its_line) {
  const auto moved = [](int vertex, const Eigen::Vector3d& to) {
    auto vertices = unit_square;
    vertices[vertex] = to;
    return vertices;
  };
  const struct {
    Mesh mesh;
    std::string place, words;
  } cases[] = {
      {make_mesh({}, {}), "cloth.obj", "no faces"},
      {make_mesh(unit_square, {}), "cloth.obj", "no faces"},
      {make_mesh(unit_square, {{0, 1, 2, 3}, {0, 1}}), "cloth.obj:6", "2 corners"},
      {make_mesh(unit_square, {{0, 1, 2, 3}, {2, 0, 1, 2}}), "cloth.obj:6", "vertex 3 twice"},
      {make_mesh(unit_square, {{0, 1, 2, 4}}), "cloth.obj:5", "vertex 5, expected 1 to 4"},
      {make_mesh(unit_square, {{0, 1, -1}}), "cloth.obj:5", "vertex 0, expected 1 to 4"},
      {make_mesh(unit_square, {{0, 1, 3}}), "cloth.obj:3", "vertex 3 belongs to no face"},
      {make_mesh(moved(1, {0, nan_value, 0}), {{0, 1, 2, 3}}), "cloth.obj:2", "not finite"},
      {make_mesh(moved(1, {0, 0, -inf}), {{0, 1, 2, 3}}), "cloth.obj:2", "not finite"},
      {make_mesh(moved(2, {1, 0, 0}), {{0, 1, 3}, {1, 2, 3}}), "cloth.obj:6", "edge 2-3 has length zero"},
      {make_mesh(moved(2, {0, 0, 0}), {{0, 1, 2, 3}}), "cloth.obj:5", "diagonal 1-3 has length zero"},
      {make_mesh(moved(3, {1, 0, 0}), {{0, 1, 2}, {0, 2, 3}}), "cloth.obj:6",
       "bending spring 2-4 has length zero"},
      {make_mesh(moved(1, {1e200, 0, 0}), {{0, 1, 2, 3}}), "cloth.obj:5", "edge 1-2 has length inf"},
      // thin only by rounding: 0.1, 0.2, 0.3 are not exactly on a line
      {make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 0.7}, {0.2, 0.2, 1.4}, {0.3, 0.3, 2.1}},
                 {{0, 1, 2}, {3, 4, 5}}),
       "cloth.obj:4", "vertex 4 has a mass of 0 kg"},
  };
  for (const auto& c : cases) expect_error([&] { make_net(c.mesh, {}); }, c.place, c.words);
}

BOOST_AUTO_TEST_CASE(a_bad_grid_is_refused) {
  const struct {
    Grid grid;
    std::string words;
  } cases[] = {
      {{0, 4, 0.1}, "0 x 4"},
      {{4, -1, 0.1}, "4 x -1"},
      {{5000, 4001, 0.1}, "at most 20000000"},
      {{2'000'000'000, 2'000'000'000, 0.1}, "at most 20000000"},
      {{2, 2, 0}, "spacing is 0"},
      {{2, 2, -0.1}, "spacing is -0.1"},
      {{2, 2, nan_value}, "spacing is nan"},
      {{2, 2, inf}, "spacing is inf"},
      {{2, 2, 1e-200}, "spacing is 1e-200"},
  };
  for (const auto& c : cases) expect_error([&] { make_net(c.grid, {}); }, "grid", c.words);
  expect_error([] { check(Grid{0, 1, 1}, "--grid"); }, "--grid", "0 x 1");
  expect_error([] { make_net(Grid{1, 1, 1e-100}, {.area_density = 1e-200}); }, "grid", "weighs 0 kg");
}

BOOST_AUTO_TEST_CASE(a_bad_material_is_refused) {
  const struct {
    SpringMaterial material;
    std::string words;
  } cases[] = {
      {{.area_density = 0}, "area density is 0"},
      {{.area_density = nan_value}, "area density is nan"},
      {{.particle_mass = -1.0}, "particle mass is -1"},
      {{.particle_mass = inf}, "particle mass is inf"},
      {{.stiffness = {-1, 0, 0}}, "structural stiffness is -1"},
      {{.stiffness = {1, nan_value, 0}}, "shear stiffness is nan"},
      {{.stiffness = {1, 0, inf}}, "bending stiffness is inf"},
      {{.damping = {-0.1, 0, 0}}, "structural damping is -0.1"},
      {{.damping = {0, 0, inf}}, "bending damping is inf"},
      {{.stiffness = {1, 0, 1}, .damping = {0, 0.5, 0}}, "shear damping is 0.5, expected zero"},
  };
  for (const auto& c : cases) {
    expect_error([&] { check(c.material, "scene.json", 3); }, "scene.json:3", c.words);
    expect_error([&] { make_net(Grid{2, 2, 0.1}, c.material); }, "material", c.words);
    expect_error([&] { make_net(quad_mesh({2, 2, 0.1}), c.material); }, "material", c.words);
  }
}

BOOST_AUTO_TEST_SUITE_END()
