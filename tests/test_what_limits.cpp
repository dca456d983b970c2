// What decides the step: matrices of single elements against the whole, shares of the stiffest mode's energy,
// bounds on k0 without an eigenvalue of the whole.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "analysis/limits/stiffest_motion.h"
#include "analysis/limits/structure_limits.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/springs.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"
#include "tests/command.h"
#include "tests/dense.h"
#include "tests/random_nets.h"

BOOST_AUTO_TEST_SUITE(what_limits)

using namespace springstab;
using springstab::test::Command;
using springstab::test::lines;
using springstab::test::Outcome;

namespace {

const std::vector<int> two_held{0, 3};

/// A cloth away from its rest, two particles pinned, and its elements there.
template <class Cloth>
struct Displaced {
  explicit Displaced(Cloth of)
      : cloth(heavier(std::move(of))), scene(cloth, two_held, {0, -9.81, 0}, {}), state(scene.rest_state()) {
    state.x += 0.02 * test::random_vector(state.x.size(), 4);
    structure = structure_of(scene, state);
    elements.visit_all = [this](const ElementVisitor& visit) {
      visit_elements(cloth, scene.positions(state.x), visit);
    };
    int free = 0;
    for (int i = 0; i < scene.particles(); ++i)
      elements.place.push_back(i == two_held[0] || i == two_held[1] ? -1 : free++);
  }
  static Cloth heavier(Cloth cloth) {
    for (std::size_t i = 0; i < cloth.mass.size(); ++i)
      cloth.mass[i] *= 1 + 0.3 * static_cast<double>((7 * i) % 5);
    return cloth;
  }

  Cloth cloth;
  Scene scene;
  State<Vector> state;
  Structure structure;
  ElementsOf elements;
};

/// Σ K_e between what can move, and how many elements of each kind.
struct SumOfElements {
  Eigen::MatrixXd stiffness;
  std::map<std::string, long> count;
  std::vector<double> shares;  // of the mode, those of all elements

  SumOfElements(const ElementsOf& elements, Eigen::Index n, const Eigen::VectorXd& mode)
      : stiffness(Eigen::MatrixXd::Zero(n, n)) {
    elements.visit_all(
        [&](std::string_view kind, long index, std::span<const int> particles, const Eigen::MatrixXd& k) {
          BOOST_TEST(index == count[std::string(kind)]++);
          BOOST_TEST((k - k.transpose()).norm() <= 1e-12 * k.norm());
          double energy = 0;
          for (std::size_t c = 0; c < particles.size(); ++c)
            for (std::size_t d = 0; d < particles.size(); ++d) {
              const int i = elements.place[particles[c]], j = elements.place[particles[d]];
              if (i < 0 || j < 0) continue;
              const Eigen::Matrix3d block = k.block<3, 3>(3 * c, 3 * d);
              stiffness.block<3, 3>(3 * i, 3 * j) += block;
              energy += mode.segment<3>(3 * i).dot(block * mode.segment<3>(3 * j));
            }
          shares.push_back(energy);
        });
  }
};

template <class Cloth>
void expect_parts_of_the_whole(const Cloth& cloth, const std::map<std::string, long>& count) {
  const Displaced<Cloth> displaced(cloth);
  const StructuralMatrices& s = displaced.structure.matrices;
  const std::optional<StiffestMotion> motion = stiffest_motion(s, displaced.elements);
  BOOST_TEST_REQUIRE(motion.has_value());
  const Eigen::VectorXd& u = motion->mode;
  const double k0 = StructureLimits(displaced.structure).k0().value;
  BOOST_TEST(u.dot(s.mass * u) == 1, boost::test_tools::tolerance(1e-12));
  BOOST_TEST((s.stiffness * u - k0 * (s.mass * u)).norm() < 1e-8 * (s.stiffness * u).norm());

  SumOfElements sum(displaced.elements, s.size(), u);
  BOOST_TEST((sum.stiffness - Eigen::MatrixXd(s.stiffness)).norm() < 1e-13 * sum.stiffness.norm());
  BOOST_TEST((sum.count == count));
  BOOST_TEST(std::accumulate(sum.shares.begin(), sum.shares.end(), 0.0) == k0,
             boost::test_tools::tolerance(1e-9));
  std::ranges::sort(sum.shares, std::greater<>());
  BOOST_TEST_REQUIRE(motion->carriers.size() == std::min<std::size_t>(10, sum.shares.size()));
  for (std::size_t i = 0; i < motion->carriers.size(); ++i)
    BOOST_TEST(motion->carriers[i].share == sum.shares[i] / k0, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(motion->element.value() >= k0);
  BOOST_TEST(motion->nodal.value() >= k0);
  BOOST_TEST(motion->element.value() < 3 * k0);
}

}  // namespace

BOOST_AUTO_TEST_CASE(elements_are_the_parts_of_the_whole) {
  const Grid size{4, 5, 0.2};
  SpringMaterial material;
  material.stiffness = {200, 0, 20};  // no shear springs
  const SpringNet net = make_net(size, material);
  BOOST_TEST_CONTEXT("net") expect_parts_of_the_whole(net, {{"spring", std::ssize(net.springs)}});
  const TriangleCloth cloth = make_cloth(size, ClothMaterial{});
  BOOST_TEST_CONTEXT("cloth")
  expect_parts_of_the_whole(cloth, {{"triangle", 24}, {"hinge", std::ssize(cloth.hinges)}});
  TetMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1.1, 0, 0.1}, {0, 0.9, 0}, {0.2, 0.1, 1.3}, {1, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  BOOST_TEST_CONTEXT("solid")
  expect_parts_of_the_whole(make_solid(mesh, SolidMaterial{}), {{"spring", 9}, {"altitude", 8}});
}

// More than one batch of elements: 5 100 springs, of which one is stiffer by far.
BOOST_AUTO_TEST_CASE(the_stiff_spring_is_found) {
  SpringNet net = make_net(Grid{30, 30, 0.1}, SpringMaterial{});
  const std::size_t stiff = 4500;
  BOOST_TEST_REQUIRE(net.springs.size() > 4700u);
  net.springs[stiff].stiffness = 1e5;
  Displaced<SpringNet> displaced(net);
  const auto motion = stiffest_motion(displaced.structure.matrices, displaced.elements).value();
  const Carrier& first = motion.carriers.front();
  BOOST_TEST(first.kind == "spring");
  BOOST_TEST(first.index == static_cast<long>(stiff));
  BOOST_TEST((first.particles == std::vector<int>{net.springs[stiff].i, net.springs[stiff].j}));
  BOOST_TEST(first.share > 0.9);
  BOOST_TEST(first.stiffness == 2e5, boost::test_tools::tolerance(1e-9));
  const std::vector<double>& m = displaced.cloth.mass;
  BOOST_TEST(first.mass == m[first.particles[0]] + m[first.particles[1]],
             boost::test_tools::tolerance(1e-12));
}

// Two masses and a spring: k (1/m1 + 1/m2) is k0 and the element's own; the nodes say 2k/m1.
BOOST_AUTO_TEST_CASE(bounds_of_one_spring_in_closed_form) {
  const double k = 70, m1 = 0.5, m2 = 3;
  const auto make = [&](const std::vector<int>& number, int free_count) {
    return make_terms(SpringNet{{}, {}, {{0, 1, k, 0, 1}}}, number, free_count);
  };
  Scene scene({{0, 0, 0}, {1, 0, 0}}, {m1, m2}, make, {}, {0, 0, 0}, {});
  const State<Vector> state = scene.rest_state();
  const ElementsOf elements{
      [&](const ElementVisitor& visit) {
        visit_elements(SpringNet{{}, {}, {{0, 1, k, 0, 1}}}, scene.positions(state.x), visit);
      },
      {0, 1}};
  const auto motion = stiffest_motion(structure_of(scene, state).matrices, elements).value();
  BOOST_TEST(motion.element.value() == k * (1 / m1 + 1 / m2), boost::test_tools::tolerance(1e-12));
  BOOST_TEST(motion.nodal.value() == 2 * k / m1, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(motion.carriers.front().share == 1, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(bounds_hold_for_masses_and_springs_over_decades) {
  test::RandomNets random(8);
  for (int i = 0; i < 20; ++i) {
    const SpringNet net = random.net(true);
    Scene scene(net, {0}, {0, 0, 0}, {});
    const State<Vector> state = scene.rest_state();
    ElementsOf elements{[&](const ElementVisitor& visit) { visit_elements(net, net.rest, visit); },
                        std::vector<int>(net.rest.size())};
    std::iota(elements.place.begin(), elements.place.end(), -1);
    const Structure structure = structure_of(scene, state);
    const auto motion = stiffest_motion(structure.matrices, elements).value();
    const double k0 = StructureLimits(structure).k0().value;
    BOOST_TEST(motion.element.value() >= k0 * (1 - 1e-12));
    BOOST_TEST(motion.nodal.value() >= k0 * (1 - 1e-12));
    BOOST_TEST(motion.element.value() <= 2.5 * k0);
  }
}

BOOST_AUTO_TEST_CASE(of_matrices_the_unknowns_carry_it) {
  const auto sparse = [](const Eigen::MatrixXd& a) { return SparseMatrix(a.sparseView(0.0, 0.0)); };
  const Eigen::MatrixXd k{{30, -10, 0}, {-10, 350, -25}, {0, -25, 27}};
  const Eigen::MatrixXd m{{1, 0.2, 0}, {0.2, 2.5, 0.1}, {0, 0.1, 0.7}};
  const StructuralMatrices s = prepare(sparse(k), sparse(m));
  const auto motion = stiffest_motion(s).value();
  const Eigen::VectorXd& u = motion.mode;
  const double k0 = StructureLimits(structure_of(s)).k0().value;
  BOOST_TEST((k * u - k0 * (m * u)).norm() < 1e-10 * (k * u).norm());
  BOOST_TEST(u.dot(m * u) == 1, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(motion.carriers.size() == 3u);
  BOOST_TEST(motion.carriers.front().index == 1);
  double sum = 0;
  for (const Carrier& each : motion.carriers) sum += each.share;
  BOOST_TEST(sum == 1, boost::test_tools::tolerance(1e-10));
  BOOST_TEST(!motion.nodal.has_value());
  BOOST_TEST(!motion.element.has_value());
  Eigen::MatrixXd follower = k;
  follower(0, 1) = 5;
  BOOST_TEST(!stiffest_motion(prepare_nonsymmetric(sparse(follower), sparse(m))).has_value());
  BOOST_TEST(!stiffest_motion(prepare(SparseMatrix(3, 3), sparse(m))).has_value());
}

// A cloth of two triangles and a sliver, in a file whose first vertex belongs to nothing and whose last one
// stands where the third does.
BOOST_AUTO_TEST_CASE(the_command_names_the_sliver) {
  const Command command;
  command.file("cloth.obj",
               "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0.5 0 1.01\nv 1 0 0\n"
               "f 2 3 4\nf 2 4 5\nf 5 4 6\nf 7 4 3\n");
  const std::string limits = "limits cloth.obj --material baraff-witkin --pin 1 ";
  const Outcome outcome = command(limits + "--json --mode mode.csv");
  BOOST_TEST_REQUIRE(outcome.status == 0);
  const auto json = outcome.json();
  const auto& first = json["stiffest"][0];
  BOOST_TEST(first["kind"] == "triangle");
  BOOST_TEST(first["index"] == 2);
  BOOST_TEST(first["vertices"] == nlohmann::json({4, 3, 5}));
  BOOST_TEST(first["share"].get<double>() > 0.5);
  double before = 1;
  for (const auto& each : json["stiffest"]) {
    BOOST_TEST(each["share"].get<double>() <= before);
    before = each["share"];
  }
  const double k0 = json["k0"]["value"];
  for (const char* bound : {"nodal", "element"}) {
    const auto& of = json["cheap_bounds"][bound];
    BOOST_TEST(of["k0"].get<double>() >= k0);
    BOOST_TEST(of["step"].get<double>() == 2 / std::sqrt(of["k0"].get<double>()),
               boost::test_tools::tolerance(1e-12));
    BOOST_TEST(of["unused"].get<double>() == 1 - std::sqrt(k0 / of["k0"].get<double>()),
               boost::test_tools::tolerance(1e-12));
  }

  std::istringstream csv(test::content_of(command.folder() / "mode.csv"));
  std::string line;
  std::getline(csv, line);
  BOOST_TEST(line == "vertex,x,y,z,ux,uy,uz,share");
  double shares = 0;
  std::vector<int> vertices;
  while (std::getline(csv, line)) {
    vertices.push_back(std::stoi(line));
    shares += std::stod(line.substr(line.rfind(',') + 1));
  }
  BOOST_TEST((vertices == std::vector<int>{1, 2, 3, 4, 5}));
  BOOST_TEST(shares == 1, boost::test_tools::tolerance(1e-12));

  const Outcome words = command(limits + "--explain");
  BOOST_TEST(words.out.find("triangle            2") != std::string::npos);
  BOOST_TEST(words.out.find("by the stiffest element, which leaves") != std::string::npos);
  BOOST_TEST(command(limits).out.find("stiffest") == std::string::npos);
}

BOOST_AUTO_TEST_CASE(where_there_is_no_mode_none_is_made_up) {
  const Command command;
  command.file("K.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 2\n1 2 1\n2 2 5\n");
  const auto json = command("limits --stiffness K.mtx --json").json();
  BOOST_TEST(json["stiffest"].is_null());
  BOOST_TEST(json["cheap_bounds"].is_null());
  const Outcome outcome = command("limits --stiffness K.mtx --mode mode.csv");
  BOOST_TEST(outcome.status == 2);
  BOOST_TEST(lines(outcome.err) == 1);
  BOOST_TEST(!std::filesystem::exists(command.folder() / "mode.csv"));
}

// What is typed is what a scene file with these numbers says.
BOOST_AUTO_TEST_CASE(numbers_of_the_material_on_the_command_line) {
  const Command command;
  const auto answer = [&](const std::string& arguments) {
    const Outcome outcome = command("limits " + arguments + " --json");
    BOOST_TEST_REQUIRE(outcome.status == 0);
    return outcome.json();
  };
  const auto expect_scene = [&](const std::string& material, const std::string& options) {
    command.file("scene.json", R"({"geometry": {"grid": [5, 4], "spacing": 0.2}, "material": )" + material +
                                   R"(, "pins": [0, 3]})");
    const auto of_file = answer("scene.json"),
               typed = answer("--grid 5x4 --spacing 0.2 --pin 0,3 " + options);
    BOOST_TEST_CONTEXT(options) {
      BOOST_TEST(typed["k0"]["value"] == of_file["k0"]["value"]);
      BOOST_TEST(typed["total_mass"] == of_file["total_mass"]);
    }
    return typed["k0"]["value"].get<double>();
  };
  const double springs = expect_scene(R"({"structural": 70, "bending": 3, "area_density": 0.35})",
                                      "--stretch 70 --bend 3 --area-density 0.35");
  const double triangles =
      expect_scene(R"({"model": "baraff-witkin", "stretch": 700, "bending": 0.002, "area_density": 0.35})",
                   "--material baraff-witkin --stretch 700 --bend 0.002 --area-density 0.35");
  BOOST_TEST(springs > 0);
  BOOST_TEST(triangles > 0);

  // Twenty particles alike: k0 goes with 1/M.
  const auto heavy = answer("--grid 5x4 --mass-total 3"), light = answer("--grid 5x4 --mass-total 1.5");
  BOOST_TEST(heavy["total_mass"].get<double>() == 3, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(2 * heavy["k0"]["value"].get<double>() == light["k0"]["value"].get<double>(),
             boost::test_tools::tolerance(1e-9));

  command.file("K.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 2\n");
  command.file("scene.json", R"({"geometry": {"grid": [5, 4]}})");
  for (const char* arguments : {"--grid 3x3 --stretch 0", "--grid 3x3 --bend -1",
                                "--grid 3x3 --mass-total nan", "--grid 3x3 --area-density 1 --mass-total 1",
                                "scene.json --bend 1", "--stiffness K.mtx --mass-total 1"}) {
    const Outcome outcome = command(std::string("limits ") + arguments);
    BOOST_TEST_CONTEXT(arguments << ": " << outcome.err) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(lines(outcome.err) == 1);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
