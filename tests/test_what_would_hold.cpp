// Questions asked backwards: every answer is put to the limits of the structure so changed, where the method
// holds, and a little less of it, where it does not.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>
#include <set>

#include "analysis/limits/for_step.h"
#include "solvers/scene/scene.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"
#include "tests/command.h"
#include "tests/dense.h"
#include "tests/random_nets.h"

BOOST_AUTO_TEST_SUITE(what_would_hold)

using namespace springstab;
using springstab::test::Command;
using springstab::test::lines;
using springstab::test::Outcome;

namespace {

using MethodNames = std::vector<std::string>;

const MethodNames exact_methods{"symplectic-euler", "implicit-damping-euler", "newmark:beta=0,gamma=0.5"};
const MethodNames modal_methods{"explicit-euler",        "rk2", "rk4", "symplectic-euler", "velocity-verlet",
                                "implicit-damping-euler"};

struct TwoLimits {
  double h_max, h_certified;
};

TwoLimits limits_of_changed(const Structure& structure, const StructureChange& change, const Method& method) {
  StructureLimits limits(changed(structure, change));
  const MethodLimits& l = limits.limits(method);
  return {l.h_max.value_or(0), l.h_certified.value_or(0)};
}

struct Asked {
  const Structure& structure;
  Method method;
  double step;
  bool by_proof;  // the structure's own proof reaches its h_max
};

void expect_holds(const Asked& asked, const StructureChange& change) {
  const TwoLimits limits = limits_of_changed(asked.structure, change, asked.method);
  BOOST_TEST(limits.h_max > asked.step);
  if (asked.by_proof) BOOST_TEST(limits.h_certified >= asked.step);
}

void expect_fails(const Asked& asked, const StructureChange& change) {
  BOOST_TEST(limits_of_changed(asked.structure, change, asked.method).h_max < asked.step);
}

void expect_scaling(const Asked& asked, const MassScaling& scaling, double uniform, int width) {
  const SparseMatrix& mass = asked.structure.matrices.mass;
  const Eigen::VectorXd added = scaling.of_unknowns(mass.rows(), width);
  BOOST_TEST(scaling.proved);
  BOOST_TEST(added.sum() == width * scaling.added_mass, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(scaling.added_mass >= scaling.least);
  BOOST_TEST(scaling.added_mass <= 1.002 * scaling.least);
  if (uniform > 1)
    BOOST_TEST(scaling.added_mass <= (uniform - 1) * mass.diagonal().sum() / width * (1 + 1e-6));
  const TwoLimits limits = limits_of_changed(asked.structure, {.added_mass = added}, asked.method);
  BOOST_TEST(limits.h_max > asked.step);
  BOOST_TEST(limits.h_certified >= asked.step);
  expect_fails(asked, {.added_mass = 0.99 * added});
}

/// Which of the answers there were.
std::set<std::string> expect_answers(const Structure& structure, const Method& method, double over,
                                     int width) {
  StructureLimits limits(structure);
  const MethodLimits& own = limits.limits(method);
  std::set<std::string> given;
  if (!own.h_max || std::isinf(*own.h_max)) return given;
  const Asked asked{structure, method, over * *own.h_max,
                    own.h_certified && *own.h_certified >= (1 - 1e-7) * *own.h_max};
  ForStep question(limits, asked.step, width);
  const StepAnswer answer = question.of(method);
  BOOST_TEST((answer.holds == false));
  BOOST_TEST(!answer.proved);
  BOOST_TEST(*answer.margin == 1 / over, boost::test_tools::tolerance(1e-12));
  if (const auto& s = answer.stiffness_factor.value) {
    given.insert("stiffness");
    expect_holds(asked, {.stiffness = *s});
    expect_fails(asked, {.stiffness = 1.01 * *s});
  }
  if (const auto& m = answer.mass_factor.value) {
    given.insert("mass");
    expect_holds(asked, {.mass = *m});
    expect_fails(asked, {.mass = 0.99 * *m});
  }
  if (const auto& alpha = answer.alpha.value) {
    given.insert("alpha");
    const auto [low, high] = *alpha;
    expect_holds(asked, {.alpha = low});
    expect_holds(asked, {.alpha = std::isinf(high) ? 1e3 * asked.step + low : high});
    if (low > 0) expect_fails(asked, {.alpha = 0.99 * low});
    if (std::isfinite(high)) expect_fails(asked, {.alpha = high > 0 ? 1.01 * high : 1e-6 * asked.step});
  }
  if (const auto& scaling = answer.mass_scaling.value) {
    given.insert("scaling");
    expect_scaling(asked, *scaling, answer.mass_factor.value.value_or(0), width);
  }
  if (const auto& n = answer.substeps.value) {
    given.insert("substeps");
    BOOST_TEST(asked.step / static_cast<double>(*n) <= *own.h_certified);
    BOOST_TEST(asked.step / static_cast<double>(*n - 1) > *own.h_certified);
  }
  for (const std::string_view reason :
       {answer.stiffness_factor.reason, answer.mass_factor.reason, answer.alpha.reason,
        answer.mass_scaling.reason, answer.substeps.reason})
    BOOST_TEST((reason.empty() || reason.size() > 10));
  return given;
}

void expect_all(const Structure& structure, const MethodNames& methods, int width, double over,
                const std::set<std::string>& expected) {
  std::set<std::string> given;
  for (const std::string& method : methods) BOOST_TEST_CONTEXT(method << " at " << over << " h_max")
  given.merge(expect_answers(structure, method, over, width));
  BOOST_TEST(given == expected, boost::test_tools::per_element());
}

const std::set<std::string> all_answers{"alpha", "mass", "scaling", "stiffness", "substeps"};

template <class Cloth>
Structure scene_of(Cloth cloth, const RayleighDamping& damping) {
  for (std::size_t i = 0; i < cloth.mass.size(); ++i)
    cloth.mass[i] *= 1 + 0.3 * static_cast<double>((7 * i) % 5);
  Scene scene(cloth, {0, 3}, {0, -9.81, 0}, damping);
  return structure_of(scene, scene.rest_state());
}

SparseMatrix as_sparse(const Eigen::MatrixXd& a) { return a.sparseView(0.0, 0.0); }

}  // namespace

BOOST_AUTO_TEST_CASE(one_oscillator_in_closed_form) {
  const double k = 100, m = 2, step = 0.4;  // H² k/m = 8, symplectic Euler's limit is 4
  StructureLimits limits(
      structure_of(prepare(as_sparse(Eigen::MatrixXd{{k}}), as_sparse(Eigen::MatrixXd{{m}}))));
  const StepAnswer answer = ForStep(limits, step, 1).of("symplectic-euler");
  BOOST_TEST((answer.holds == false));
  BOOST_TEST(*answer.margin == std::sqrt(0.5), boost::test_tools::tolerance(1e-7));
  BOOST_TEST(*answer.stiffness_factor.value == 0.5, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(*answer.mass_factor.value == 2.0, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(answer.mass_scaling.value->added_mass == 2.0, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(answer.mass_scaling.value->least == 2.0, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(*answer.substeps.value == 2);
  BOOST_TEST(!answer.alpha.value.has_value());  // damping makes its limit shorter
  // explicit Euler holds on the line X >= Y, X <= 4: H <= alpha, and H <= 4/(alpha k').
  const StepAnswer euler = ForStep(limits, 0.1, 1).of("explicit-euler");
  BOOST_TEST((euler.holds == false));
  BOOST_TEST(euler.alpha.value->low == 0.1, boost::test_tools::tolerance(1e-7));
  BOOST_TEST(!euler.stiffness_factor.value.has_value());
  BOOST_TEST(euler.stiffness_factor.reason == "no positive step is stable, however soft or heavy");
  BOOST_TEST((ForStep(limits, 0.2, 1).of("symplectic-euler").holds == true));
  BOOST_TEST(ForStep(limits, 0.2, 1).of("symplectic-euler").proved);
  BOOST_TEST((ForStep(limits, 1e9, 1).of("implicit-euler").holds == true));
  BOOST_CHECK_THROW(ForStep(limits, 0, 1), std::invalid_argument);
  BOOST_CHECK_THROW(ForStep(limits, 1, 2), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(nets_of_modes, *boost::unit_test::label("slow")) {
  test::RandomNets random(5);
  for (int i = 0; i < 3; ++i) {
    StructuralMatrices s = test::matrices(random.net(i % 2 == 0));
    s.damping = i < 1 ? SparseMatrix() : SparseMatrix(random.uniform(0, 1) * s.mass + 1e-4 * s.stiffness);
    expect_all(structure_of(s), modal_methods, 3, random.uniform(1.05, 3), all_answers);
  }
}

BOOST_AUTO_TEST_CASE(nets_with_dampers) {
  test::RandomNets random(3);
  for (int i = 0; i < 6; ++i) {
    const Structure structure = structure_of(test::matrices(random.net(i % 2 == 0), i % 3));
    BOOST_TEST((structure.damping.kind == DampingModel::Kind::general));
    expect_all(structure, exact_methods, 3, random.uniform(1.05, 2), all_answers);
    if (structure.matrices.size() <= 12)
      expect_all(structure, {"rk4", "rk2"}, 3, 1.3, {"alpha", "mass", "stiffness", "substeps"});
  }
}

BOOST_AUTO_TEST_CASE(scenes, *boost::unit_test::label("slow")) {
  const Grid size{4, 5, 0.2};
  BOOST_TEST_CONTEXT("cloth") {
    expect_all(scene_of(make_cloth(size, ClothMaterial{}), {1, 1e-4}),
               {"explicit-euler", "rk4", "symplectic-euler"}, 3, 1.2, all_answers);
  }
  BOOST_TEST_CONTEXT("net with dampers, d0 and alpha") {
    SpringMaterial material;
    material.damping = {0.01, 0.02, 0.03};
    const Structure structure = scene_of(make_net(size, material), {0.5, 1e-5});
    BOOST_TEST((structure.damping.kind == DampingModel::Kind::general));
    expect_all(structure, exact_methods, 3, 1.3, all_answers);
  }
  BOOST_TEST_CONTEXT("solid") {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1.2, 0}, {0, 0, 0.9}, {1, 1, 1.1}};
    mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    expect_all(scene_of(make_solid(mesh, SolidMaterial{}), {0.2, 0}), {"rk4", "symplectic-euler"}, 3, 1.4,
               {"mass", "scaling", "stiffness", "substeps"});
  }
}

BOOST_AUTO_TEST_CASE(matrices_that_are_not_symmetric) {
  const Eigen::MatrixXd k{{30, -10, 0}, {-14, 35, -25}, {0, -22, 27}};
  const Eigen::MatrixXd m{{1, 0, 0}, {0, 2.5, 0}, {0, 0, 0.7}}, d{{0.3, 0.1, 0}, {0, 0.2, 0}, {0, 0, 0.4}};
  const Structure structure = structure_of(prepare_nonsymmetric(as_sparse(k), as_sparse(m), as_sparse(d)));
  expect_all(structure, {"rk4", "rk2"}, 1, 1.3, {"alpha", "mass", "stiffness"});
  StructureLimits limits(structure);
  const StepAnswer answer = ForStep(limits, 10, 1).of("rk4");
  BOOST_TEST(answer.mass_scaling.reason == "K or D is not symmetric");
  BOOST_TEST(answer.substeps.reason == "no step is proved");
}

BOOST_AUTO_TEST_CASE(added_masses_against_the_matrix_and_against_others) {
  test::RandomNets random(11);
  for (int i = 0; i < 5; ++i) {
    const Structure structure = structure_of(test::matrices(random.net(true), 1));
    const StructuralMatrices& s = structure.matrices;
    StructureLimits limits(structure);
    const double step = 1.4 * *limits.limits("symplectic-euler").h_max;
    const MassScaling scaling = ForStep(limits, step, 3).of("symplectic-euler").mass_scaling.value.value();
    // 4M ≻ 2HD + H²K, the d0 = 1 of D with the new mass
    const SparseMatrix dampers = s.damping - structure.damping.d0 * s.mass;
    const double c = 4 - 2 * step * structure.damping.d0;
    const Eigen::VectorXd mass = s.mass.diagonal();
    const Eigen::MatrixXd rest = Eigen::MatrixXd(2 * step * dampers + step * step * s.stiffness);
    const auto lacking = [&](const Eigen::VectorXd& added) {
      const Eigen::VectorXd root = (mass + added).cwiseSqrt().cwiseInverse();
      Eigen::MatrixXd scaled = root.asDiagonal() * (-rest) * root.asDiagonal();
      scaled.diagonal().array() += c;
      return test::smallest_eigenvalue(scaled);
    };
    const Eigen::VectorXd added = scaling.of_unknowns(s.size(), 3);
    BOOST_TEST(lacking(added) > 0);
    BOOST_TEST(lacking(added) < 1e-3 * c);
    // Other masses that do are no less.
    for (int trial = 0; trial < 20; ++trial) {
      Eigen::VectorXd other(s.size());
      for (Eigen::Index p = 0; p < other.size(); p += 3)
        other.segment(p, 3).setConstant((added[p] + 0.1 * mass[p]) * random.log_uniform(-1, 0.5));
      double factor = 1e-3;
      while (lacking(factor * other) < 0 && factor < 1e6) factor *= 1.02;
      BOOST_TEST(factor * other.sum() / 3 >= scaling.least * (1 - 1e-9));
    }
  }
}

BOOST_AUTO_TEST_CASE(the_command_answers) {
  const Command command;
  const std::string grid = "limits --grid 6x5 --pin corners --methods symplectic-euler,implicit-euler,rk4 ";
  const Outcome frame = command(grid + "--frame-rate 60 --substeps 2 --json");
  BOOST_TEST_REQUIRE(frame.status == 0);
  const auto answers = frame.json()["for_step"];
  BOOST_TEST(answers.size() == 3u);
  BOOST_TEST(answers["implicit-euler"]["holds"] == true);
  BOOST_TEST(answers["implicit-euler"]["margin"] == "inf");
  BOOST_TEST(!answers["implicit-euler"].contains("substeps"));
  const auto& symplectic = answers["symplectic-euler"];
  BOOST_TEST(symplectic["step"].get<double>() == 1.0 / 120);
  BOOST_TEST(symplectic["holds"] == false);
  const double margin = symplectic["margin"];
  BOOST_TEST(symplectic["stiffness_factor"].get<double>() == margin * margin,
             boost::test_tools::tolerance(1e-6));
  BOOST_TEST(symplectic["uniform_mass_factor"].get<double>() == 1 / (margin * margin),
             boost::test_tools::tolerance(1e-6));
  BOOST_TEST(symplectic["substeps"].get<long>() == static_cast<long>(std::ceil(1 / margin)));
  BOOST_TEST(symplectic["alpha"].is_null());
  BOOST_TEST(symplectic["reasons"]["alpha"].get<std::string>().size() > 10u);
  double sum = 0;
  for (const auto& each : symplectic["mass_scaling"]["particles"]) {
    const long index = each["index"];
    BOOST_TEST((index > 0 && index < 29 && index != 4 && index != 25));  // the corners are pinned
    sum += each["added_mass"].get<double>();
  }
  BOOST_TEST(sum == symplectic["mass_scaling"]["added_mass"].get<double>(),
             boost::test_tools::tolerance(1e-12));
  BOOST_TEST(symplectic["mass_scaling"]["proved"] == true);

  // The same step, in words, and no new words where nothing was asked.
  const Outcome words = command(grid + "--for-step 0.00833333333333333");
  BOOST_TEST(words.status == 0);
  BOOST_TEST(words.out.find("at a step of 0.00833333 s") != std::string::npos);
  BOOST_TEST(words.out.find("kg to particles") != std::string::npos);
  const Outcome rate = command(grid + "--frame-rate 60 --json");
  BOOST_TEST(!rate.json().contains("for_step"));
  BOOST_TEST(rate.json()["methods"][0]["frame_step"].is_number());
}

BOOST_AUTO_TEST_CASE(condensed_unknowns_keep_their_numbers) {
  const Command command;
  command.file(
      "K.mtx",
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 2\n2 1 -1\n2 2 500\n3 2 -1\n3 3 900\n");
  command.file("M.mtx", "%%MatrixMarket matrix coordinate real symmetric\n3 3 2\n2 2 1\n3 3 1\n");
  const auto json =
      command("limits --stiffness K.mtx --mass M.mtx --method symplectic-euler --for-step 0.07 --json")
          .json();
  const auto& scaling = json["for_step"]["symplectic-euler"]["mass_scaling"];
  BOOST_TEST_REQUIRE(scaling["particles"].size() == 1u);
  BOOST_TEST(scaling["particles"][0]["index"] == 2);  // the stiffest, the third
}

BOOST_AUTO_TEST_CASE(what_cannot_be_asked_is_said_in_one_line) {
  const Command command;
  for (const auto& [arguments, word] : {std::pair{"--substeps 10", "--frame-rate"},
                                        {"--frame-rate 60 --substeps 0", "--substeps"},
                                        {"--for-step 0", "--for-step"},
                                        {"--for-step nan", "--for-step"},
                                        {"--for-step 0.1 --frame-rate 60 --substeps 2", "both given"}}) {
    const Outcome outcome = command(std::string("limits --grid 3x3 ") + arguments);
    BOOST_TEST_CONTEXT(arguments << ": " << outcome.err) {
      BOOST_TEST(outcome.status == 2);
      BOOST_TEST(lines(outcome.err) == 1);
      BOOST_TEST(outcome.err.find(word) != std::string::npos);
      BOOST_TEST(outcome.out.empty());
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()
